#include "shared/hierarchy/tree_bitstring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace meshfront {
namespace {

using Bytes = std::vector<uint8_t>;

NodeId node(uint32_t tree, const char* path) {
  NodeId id = NodeId::root(tree);
  for (; *path != 0; ++path) id = id.child(*path == 'r');
  return id;
}

// A random antichain in preorder.
std::vector<NodeId> randomSet(std::mt19937_64& random, unsigned deepest) {
  std::vector<NodeId> nodes;
  uint32_t tree = 0;
  for (uint64_t trees = random() % 6; trees > 0; --trees) {
    tree += static_cast<uint32_t>(random() % 40);
    std::vector<NodeId> stack{NodeId::root(tree)};
    while (!stack.empty()) {
      const NodeId top = stack.back();
      stack.pop_back();
      if (top.depth == deepest || random() % 3 == 0) {
        nodes.push_back(top);
        continue;
      }
      const uint64_t sides = 1 + random() % (stack.size() > 20 ? 2 : 3);
      if ((sides & 2) != 0) stack.push_back(top.child(true));
      if ((sides & 1) != 0) stack.push_back(top.child(false));
    }
    ++tree;
  }
  return nodes;
}

TEST(NodeId, OrdersInPreorder) {
  const std::vector<NodeId> order{node(0, ""),   node(0, "l"), node(0, "ll"),
                                  node(0, "lr"), node(0, "r"), node(0, "rl"),
                                  node(0, "rr"), node(1, ""),  node(1, "rrr")};
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
  EXPECT_TRUE(node(0, "l").isAncestorOf(node(0, "lr")));
  EXPECT_TRUE(node(0, "lr").isAncestorOf(node(0, "lr")));
  EXPECT_FALSE(node(0, "r").isAncestorOf(node(0, "lr")));
  EXPECT_FALSE(node(0, "lr").isAncestorOf(node(0, "l")));
  EXPECT_EQ(node(0, "lrr").parent(), node(0, "lr"));
  EXPECT_EQ(node(7, "lrrl").ancestor(2), node(7, "lr"));
  EXPECT_EQ(node(7, "lrrl").ancestor(0), NodeId::root(7));
}

TEST(TreeBitstring, HasLiteralBytes) {
  // No tree: Exp-Golomb 3 of 0 = 1000.
  EXPECT_EQ(encodeTreeBitstring({}).value(), Bytes{0b10000000});
  // One tree (1001), its id 0 (1), its root wanted (00).
  EXPECT_EQ(encodeTreeBitstring(std::vector{node(0, "")}).value(), Bytes{0b10011000});
  // Two trees (1010); tree 1 (010): root 11, l 00, r 10, rl 00; tree 2 (gap 0: 1): root 01, r 00.
  EXPECT_EQ(encodeTreeBitstring(std::vector{node(1, "l"), node(1, "rl"), node(2, "r")}).value(),
            (Bytes{0b10100101, 0b10010001, 0b01000000}));
}

TEST(TreeBitstring, GivesSetsBackAndTakesOneEncoding) {
  std::mt19937_64 random(5);
  for (int round = 0; round < 2000; ++round) {
    const auto nodes = randomSet(random, round % 2 == 0 ? 12 : kMaxDepth);
    const Bytes bytes = encodeTreeBitstring(nodes).value();
    const auto back = decodeTreeBitstring(bytes, nodes.size());
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(*back, nodes);
    // Whatever else decodes must encode to itself: no two byte strings mean one set.
    Bytes other = bytes;
    other[random() % other.size()] ^= static_cast<uint8_t>(1U << random() % 8);
    if (const auto set = decodeTreeBitstring(other, 10000)) {
      EXPECT_EQ(encodeTreeBitstring(*set).value(), other);
    }
    Bytes longer = bytes;
    longer.push_back(0);
    EXPECT_FALSE(decodeTreeBitstring(longer, 10000));
  }
}

TEST(TreeBitstring, RefusesEveryTruncation) {
  std::mt19937_64 random(6);
  for (int round = 0; round < 50; ++round) {
    const auto nodes = randomSet(random, 30);
    const Bytes bytes = encodeTreeBitstring(nodes).value();
    for (size_t length = 0; length < bytes.size(); ++length) {
      const auto set = decodeTreeBitstring(std::span(bytes).first(length), 10000);
      EXPECT_FALSE(set) << "at length " << length << " of " << bytes.size();
    }
  }
}

TEST(TreeBitstring, RefusesWhatIsNoSet) {
  EXPECT_FALSE(encodeTreeBitstring(std::vector{node(1, ""), node(0, "")}));
  EXPECT_FALSE(encodeTreeBitstring(std::vector{node(0, "l"), node(0, "l")}));
  EXPECT_FALSE(encodeTreeBitstring(std::vector{node(0, "l"), node(0, "lr")}));
  // A path of 64 steps: one tree, id 0, then 64 times "left".
  BitWriter deep;
  deep.write(0b10011, 5);
  for (int i = 0; i < 64; ++i) deep.write(0b10, 2);
  deep.write(0, 2);
  EXPECT_FALSE(decodeTreeBitstring(deep.take(), 10));
}

TEST(TreeBitstring, KeepsToItsLimit) {
  const auto bytes = encodeTreeBitstring(std::vector{node(0, "l"), node(0, "r")}).value();
  const auto refused = decodeTreeBitstring(bytes, 1);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::tooLarge);
}

TEST(TreeBitstring, SurvivesAnyBytes) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 20000; ++round) {
    Bytes bytes(random() % 40);
    for (auto& byte : bytes) byte = static_cast<uint8_t>(random());
    if (const auto set = decodeTreeBitstring(bytes, 100)) {
      EXPECT_LE(set->size(), 100U);
      EXPECT_EQ(encodeTreeBitstring(*set).value(), bytes);
    }
  }
}

}  // namespace
}  // namespace meshfront
