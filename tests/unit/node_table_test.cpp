#include "shared/store/node_table.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace meshfront {
namespace {

NodeId randomNode(std::mt19937& random) {
  NodeId node = NodeId::root(static_cast<uint32_t>(random() % 7));
  for (auto depth = random() % 9; depth > 0; --depth) node = node.child(random() % 2 == 0);
  return node;
}

TEST(NodeTable, BehavesLikeAMap) {
  std::mt19937 random(5);
  NodeTable<uint32_t> table;
  std::map<NodeId, uint32_t> map;
  for (uint32_t step = 0; step < 60000; ++step) {
    const NodeId node = randomNode(random);
    // Phases that mostly add and that mostly remove, so that the table grows and shrinks.
    const bool adding = random() % 10 < (step / 10000 % 2 == 0 ? 7U : 2U);
    if (adding) {
      EXPECT_EQ(table.insert(node, step), map.emplace(node, step).second);
    } else {
      EXPECT_EQ(table.erase(node), map.erase(node) == 1);
    }
    ASSERT_EQ(table.size(), map.size());
    if (step % 500 != 0) continue;
    for (const auto& [key, value] : map) {
      const uint32_t* found = table.find(key);
      ASSERT_NE(found, nullptr);
      ASSERT_EQ(*found, value);
    }
  }
}

TEST(NodeTable, TellsNodesOfOnePathApart) {
  NodeTable<uint32_t> table;
  NodeId node = NodeId::root(3);
  for (uint32_t depth = 0; depth <= kMaxDepth; ++depth) {
    EXPECT_TRUE(table.insert(node, depth));
    if (depth < kMaxDepth) node = node.child(false);
  }
  node = NodeId::root(3);
  for (uint32_t depth = 0; depth <= kMaxDepth; ++depth) {
    ASSERT_NE(table.find(node), nullptr);
    EXPECT_EQ(*table.find(node), depth);
    if (depth < kMaxDepth) node = node.child(false);
  }
  EXPECT_EQ(table.find(NodeId::root(2)), nullptr);
}

TEST(NodeTable, GivesMemoryBack) {
  NodeTable<uint32_t> table;
  for (uint32_t i = 0; i < 10000; ++i) table.insert(NodeId::root(i), i);
  const size_t places = table.places();
  for (uint32_t i = 0; i < 9900; ++i) table.erase(NodeId::root(i));
  EXPECT_LT(table.places(), places / 10);
  for (uint32_t i = 9900; i < 10000; ++i) EXPECT_NE(table.find(NodeId::root(i)), nullptr);
}

}  // namespace
}  // namespace meshfront
