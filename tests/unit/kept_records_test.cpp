// What is kept below the front and how it is forgotten: the same mesh comes back, and memory is
// used again.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "tests/data/mesh_shapes.h"
#include "tests/unit/encoded_mesh.h"

namespace meshfront {
namespace {

SelectivelyRefinedMesh baseMeshOf(const RecordsAtHand& records) {
  return SelectivelyRefinedMesh::fromBase(records.base()).value();
}

NodeIndex firstRootWithRecord(const SelectivelyRefinedMesh& mesh) {
  NodeIndex root = 0;
  while (mesh.isLeaf(root)) ++root;
  return root;
}

// Splits everything, without anything that was split before.
void splitToTheEnd(SelectivelyRefinedMesh& mesh, const RecordsAtHand& records) {
  bool more = true;
  while (more) {
    more = false;
    for (VertexSlot slot = 0; slot < mesh.vertexSlotCount(); ++slot) {
      const NodeIndex node = mesh.nodeAt(slot);
      if (node == kNone || mesh.isLeaf(node)) continue;
      ASSERT_TRUE(mesh.hasRecord(node) ? mesh.resplit(node) : records.split(mesh, node));
      more = true;
    }
  }
}

void collapseToTheBase(SelectivelyRefinedMesh& mesh) {
  while (mesh.splitsApplied() > 0)
    for (VertexSlot slot = 0; slot < mesh.vertexSlotCount(); ++slot) {
      const NodeIndex node = mesh.nodeAt(slot);
      if (node == kNone) continue;
      const NodeIndex parent = mesh.parent(node);
      if (parent != kNone && mesh.canCollapse(parent)) mesh.collapse(parent);
    }
}

using NamedTriangle = std::array<NodeId, 3>;
std::set<NamedTriangle> namedTriangles(const SelectivelyRefinedMesh& mesh) {
  std::set<NamedTriangle> out;
  for (const Triangle& t : mesh.drawnCorners()) {
    if (t == Triangle{}) continue;
    NamedTriangle named{mesh.id(mesh.nodeAt(t[0])), mesh.id(mesh.nodeAt(t[1])),
                        mesh.id(mesh.nodeAt(t[2]))};
    std::rotate(named.begin(), std::min_element(named.begin(), named.end()), named.end());
    out.insert(named);
  }
  return out;
}

IndexedMesh speckledTorus() {  // colours that differ so much that records are long
  IndexedMesh mesh = torus(30, 20);
  std::mt19937 random(5);
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    mesh.colours.push_back({static_cast<uint8_t>(random()), static_cast<uint8_t>(random()),
                            static_cast<uint8_t>(random()), static_cast<uint8_t>(random())});
    mesh.normals.push_back({1, static_cast<float>(i % 7), 0.5F});
  }
  return mesh;
}

TEST(KeptRecords, SplitWithoutTheService) {
  const RecordsAtHand records(encodedContent(torus(30, 20)));
  auto mesh = baseMeshOf(records);
  const NodeIndex root = firstRootWithRecord(mesh);
  const auto& place = records.of(mesh.id(root));
  EXPECT_FALSE(mesh.hasRecord(root));
  EXPECT_FALSE(mesh.keepRecord(root, *place.bytes, place.entry.bitOffset, 0));
  EXPECT_FALSE(mesh.keepRecord(root, *place.bytes, place.bytes->size() * 8, 8));
  EXPECT_FALSE(mesh.keepRecord(static_cast<NodeIndex>(mesh.nodeCount()), *place.bytes, 0, 8));
  ASSERT_TRUE(mesh.keepRecord(root, *place.bytes, place.entry.bitOffset, place.entry.bitLength));
  EXPECT_TRUE(mesh.hasRecord(root));
  EXPECT_EQ(mesh.recordsHeld(), 1U);
  EXPECT_EQ(mesh.splitsApplied(), 0U);
  ASSERT_TRUE(mesh.resplit(root));
  EXPECT_EQ(mesh.splitsApplied(), 1U);
  EXPECT_EQ(mesh.recordsHeld(), 1U);
  EXPECT_FALSE(mesh.dropRecord(root));  // it is split
}

TEST(KeptRecords, ADamagedOneCanBeReplaced) {
  const RecordsAtHand records(encodedContent(torus(30, 20)));
  auto mesh = baseMeshOf(records);
  const NodeIndex root = firstRootWithRecord(mesh);
  const auto& place = records.of(mesh.id(root));
  const auto before = namedTriangles(mesh);
  ASSERT_TRUE(
      mesh.keepRecord(root, *place.bytes, place.entry.bitOffset, place.entry.bitLength - 1));
  EXPECT_FALSE(mesh.resplit(root));
  EXPECT_EQ(namedTriangles(mesh), before);
  auto other = mesh;
  // A sound one that comes meanwhile takes its place ...
  ASSERT_TRUE(records.split(mesh, root));
  mesh.collapse(root);
  EXPECT_TRUE(mesh.resplit(root));
  EXPECT_EQ(mesh.recordsHeld(), 1U);
  // ... or it is dropped first.
  EXPECT_TRUE(other.dropRecord(root));
  EXPECT_FALSE(other.hasRecord(root));
  EXPECT_EQ(other.recordsHeld(), 0U);
  ASSERT_TRUE(records.split(other, root));
  EXPECT_EQ(namedTriangles(other), namedTriangles(mesh));
}

TEST(KeptRecords, WhatIsForgottenComesBackAlike) {
  for (const bool colours : {false, true}) {
    SCOPED_TRACE(colours);
    const RecordsAtHand records(encodedContent(colours ? speckledTorus() : torus(30, 20)));
    auto mesh = baseMeshOf(records);
    splitToTheEnd(mesh, records);
    const auto whole = namedTriangles(mesh);
    const size_t nodes = mesh.nodeCount();
    collapseToTheBase(mesh);
    EXPECT_EQ(mesh.recordsHeld(), mesh.splitCount());
    const size_t bytes = mesh.memoryBytes();
    for (unsigned round = 0; round < 4; ++round) {
      size_t forgottenNodes = 0;
      std::vector<NodeId> forgotten;
      for (NodeIndex root = 0; root < records.base().treeCount(); ++root) {
        forgottenNodes += mesh.forgetBelow(root, &forgotten);
        EXPECT_TRUE(mesh.dropRecord(root));
        EXPECT_EQ(mesh.leftChild(root), kNone);
      }
      EXPECT_EQ(forgottenNodes, 2 * mesh.splitCount());
      ASSERT_EQ(forgotten.size(), forgottenNodes);
      for (const NodeId& id : forgotten) EXPECT_FALSE(mesh.find(id));
      EXPECT_EQ(mesh.recordsHeld(), 0U);
      splitToTheEnd(mesh, records);
      EXPECT_EQ(namedTriangles(mesh), whole);
      EXPECT_EQ(mesh.nodeCount(), nodes);         // the same memory
      EXPECT_LE(mesh.memoryBytes(), bytes + 64);  // a few lists of free blocks
      for (VertexSlot slot = 0; slot < mesh.vertexSlotCount(); ++slot) {
        const NodeIndex node = mesh.nodeAt(slot);
        if (node == kNone) continue;
        EXPECT_EQ(mesh.find(mesh.id(node)), node);
      }
      collapseToTheBase(mesh);
    }
  }
}

TEST(KeptRecords, NodesBelowTheFrontKeepTheirNames) {
  const RecordsAtHand records(encodedContent(torus(30, 20)));
  auto mesh = baseMeshOf(records);
  splitToTheEnd(mesh, records);
  std::vector<NodeId> names;
  for (NodeIndex node = 0; node < mesh.nodeCount(); ++node) names.push_back(mesh.id(node));
  collapseToTheBase(mesh);
  for (NodeIndex node = 0; node < mesh.nodeCount(); ++node) {
    ASSERT_EQ(mesh.id(node), names[node]);
    if (!mesh.isKnown(node)) continue;
    ASSERT_EQ(mesh.find(names[node]), node);
  }
}

TEST(KeptRecords, PinnedNodesStay) {
  const RecordsAtHand records(encodedContent(torus(30, 20)));
  auto mesh = baseMeshOf(records);
  splitToTheEnd(mesh, records);
  NodeIndex deepest = 0;
  for (NodeIndex node = 0; node < mesh.nodeCount(); ++node)
    if (mesh.isKnown(node) && mesh.id(node).depth > mesh.id(deepest).depth) deepest = node;
  const NodeId name = mesh.id(deepest);
  ASSERT_GE(name.depth, 2);
  mesh.setPinned(deepest, true);
  collapseToTheBase(mesh);
  EXPECT_FALSE(mesh.dropRecord(name.tree));
  mesh.forgetBelow(name.tree);
  EXPECT_EQ(mesh.find(name), deepest);
  for (unsigned depth = 0; depth < name.depth; ++depth) {
    const auto node = mesh.find(name.ancestor(depth));
    ASSERT_TRUE(node);
    EXPECT_TRUE(mesh.hasRecord(*node));
    // Beside the way nothing is left below.
    const NodeIndex left = mesh.leftChild(*node);
    const NodeIndex beside = left + (name.step(depth) ? 0 : 1);
    EXPECT_EQ(mesh.leftChild(beside), kNone);
  }
  mesh.setPinned(deepest, false);
  EXPECT_TRUE(mesh.dropRecord(name.tree));
  EXPECT_FALSE(mesh.find(name));
}

TEST(KeptRecords, MemoryStaysBoundedHoweverLongOneFliesAround) {
  const RecordsAtHand records(encodedContent(speckledTorus()));
  auto mesh = baseMeshOf(records);
  std::mt19937 random(11);
  // Up to 150 splits at a time; what is collapsed is forgotten.
  size_t most = 0;
  for (unsigned step = 0; step < 40'000; ++step) {
    const auto slot = static_cast<VertexSlot>(random() % mesh.vertexSlotCount());
    const NodeIndex node = mesh.nodeAt(slot);
    if (node == kNone) continue;
    const NodeIndex parent = mesh.parent(node);
    if (mesh.splitsApplied() < 150 && !mesh.isLeaf(node)) {
      ASSERT_TRUE(records.split(mesh, node));
    } else if (parent != kNone && mesh.canCollapse(parent)) {
      mesh.collapse(parent);
      mesh.forgetBelow(parent);
      ASSERT_TRUE(mesh.dropRecord(parent));
    }
    if (step == 10'000) most = mesh.memoryBytes();
  }
  EXPECT_LE(mesh.memoryBytes(), most + most / 8);
  EXPECT_LE(mesh.nodeCount(), records.base().treeCount() + 1 + 2 * 150);
  EXPECT_EQ(mesh.recordsHeld(), mesh.splitsApplied());
}

TEST(KeptRecords, BytesAfterSaysWhatSplitsWillTake) {
  const RecordsAtHand records(encodedContent(sphere(4)));
  for (const bool tracked : {false, true}) {
    auto mesh = baseMeshOf(records);
    if (tracked) (void)mesh.takeUpdate();
    for (NodeIndex node = 0; node < mesh.nodeCount(); ++node) {
      if (mesh.isLeaf(node)) continue;
      const size_t promised = mesh.bytesAfter(1, 1);
      ASSERT_TRUE(records.split(mesh, node));
      ASSERT_LE(mesh.bytes(), promised);
    }
    EXPECT_TRUE(mesh.complete());
    const size_t whole = mesh.bytes();
    collapseToTheBase(mesh);
    EXPECT_EQ(mesh.bytesAfter(mesh.splitCount(), 0), whole);
  }
}

}  // namespace
}  // namespace meshfront
