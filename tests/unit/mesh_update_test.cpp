// Updates applied to a copy give what a look at the whole mesh gives, bit for bit.
#include "shared/refinement/mesh_update.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/data/mesh_shapes.h"
#include "tests/data/nasty_meshes.h"
#include "tests/unit/encoded_mesh.h"

namespace meshfront {
namespace {

// What a drawer keeps: nothing but what updates told it.
struct ShadowMesh {
  std::vector<DrawnVertex> vertices;
  std::vector<Triangle> corners;

  void apply(const MeshUpdate& update) {
    ASSERT_GE(update.vertexSlots, vertices.size());
    ASSERT_GE(update.faceSlots, corners.size());
    ASSERT_EQ(update.slots.size(), update.vertices.size());
    ASSERT_EQ(update.faces.size(), update.corners.size());
    ASSERT_TRUE(std::is_sorted(update.slots.begin(), update.slots.end()));
    ASSERT_TRUE(std::is_sorted(update.born.begin(), update.born.end()));
    ASSERT_TRUE(std::is_sorted(update.faces.begin(), update.faces.end()));
    ASSERT_TRUE(std::includes(update.slots.begin(), update.slots.end(), update.born.begin(),
                              update.born.end()));
    vertices.resize(update.vertexSlots);
    corners.resize(update.faceSlots);
    for (size_t i = 0; i < update.slots.size(); ++i) vertices[update.slots[i]] = update.vertices[i];
    for (size_t i = 0; i < update.faces.size(); ++i) corners[update.faces[i]] = update.corners[i];
  }
};

// The place of the vertex's deepest ancestor-or-self that is a right child, less that step.
GridPosition slidesFrom(const SelectivelyRefinedMesh& mesh, NodeIndex node) {
  while (mesh.parent(node) != kNone && mesh.leftChild(mesh.parent(node)) == node)
    node = mesh.parent(node);
  return mesh.position(mesh.parent(node) == kNone ? node : mesh.parent(node));
}

void expectShadowIsWhole(const ShadowMesh& shadow, const SelectivelyRefinedMesh& mesh) {
  ASSERT_EQ(shadow.vertices.size(), mesh.vertexSlotCount());
  ASSERT_TRUE(std::equal(shadow.corners.begin(), shadow.corners.end(), mesh.drawnCorners().begin(),
                         mesh.drawnCorners().end()));
  std::vector<PackedNormal> normals;
  computeVertexNormals(mesh.positions(), mesh.drawnCorners(), normals);
  const AttributeLayout& layout = mesh.attributeLayout();
  for (VertexSlot slot = 0; slot < mesh.vertexSlotCount(); ++slot) {
    const NodeIndex node = mesh.nodeAt(slot);
    if (node == kNone || mesh.isVirtual(node)) continue;
    DrawnVertex expected;
    expected.position = mesh.positions()[slot];
    expected.from = slidesFrom(mesh, node);
    expected.normal =
        layout.normalBits == 0
            ? normals[slot]
            : packUnitNormal(fromOctahedral(mesh.attributes()[slot].normal, layout.normalBits));
    if (layout.any()) expected.colour = mesh.attributes()[slot].colour;
    expected.tree = mesh.id(node).tree;
    expected.level = static_cast<uint8_t>(mesh.level(node));
    expected.isLeaf = mesh.isLeaf(node) ? 1 : 0;
    expected.depth = mesh.id(node).depth;
    expected.node = node;
    ASSERT_EQ(shadow.vertices[slot], expected) << "slot " << slot;
  }
}

NodeIndex randomActiveNode(const SelectivelyRefinedMesh& mesh, std::mt19937& random) {
  while (true) {
    const NodeIndex node = mesh.nodeAt(static_cast<VertexSlot>(random() % mesh.vertexSlotCount()));
    if (node != kNone) return node;
  }
}

void expectUpdatesTellAll(IndexedMesh plain, uint32_t seed) {
  const RecordsAtHand records(encodedContent(std::move(plain)));
  auto mesh = SelectivelyRefinedMesh::fromBase(records.base()).value();
  std::mt19937 random(seed);
  ShadowMesh shadow;
  MeshUpdate first = mesh.takeUpdate();
  EXPECT_TRUE(first.born.empty());
  shadow.apply(first);
  expectShadowIsWhole(shadow, mesh);
  EXPECT_TRUE(mesh.takeUpdate().empty());
  for (unsigned round = 0; round < 60; ++round) {
    const auto steps = static_cast<unsigned>(random() % 50);
    const bool growing = random() % 3 != 0;
    for (unsigned step = 0; step < steps; ++step) {
      NodeIndex node = randomActiveNode(mesh, random);
      if (random() % 4 != 0 ? growing : !growing) {
        if (!mesh.isLeaf(node)) {
          ASSERT_TRUE(mesh.hasRecord(node) ? mesh.resplit(node) : records.split(mesh, node));
        }
      } else {
        node = mesh.parent(node);
        if (node != kNone && mesh.canCollapse(node)) mesh.collapse(node);
      }
    }
    const MeshUpdate update = mesh.takeUpdate();
    EXPECT_EQ(update.changeCount, mesh.changeCount());
    shadow.apply(update);
    expectShadowIsWhole(shadow, mesh);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

IndexedMesh withColoursAndNormals(IndexedMesh mesh, bool colours, bool normals) {
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const auto shade = static_cast<uint8_t>(i * 7);
    const auto angle = static_cast<float>(i) * 0.1F;
    if (colours) mesh.colours.push_back({shade, static_cast<uint8_t>(shade / 2), 9, 255});
    if (normals) mesh.normals.push_back({std::cos(angle), std::sin(angle), 0.5F});
  }
  return mesh;
}

TEST(MeshUpdate, TellsAllOfClosedMeshes) {
  expectUpdatesTellAll(torus(30, 20), 1);
  expectUpdatesTellAll(sphere(4), 2);
}

TEST(MeshUpdate, TellsAllOfMeshesWithBoundaries) {
  expectUpdatesTellAll(
      gridPatchWithout(24, 24, [](uint32_t x, uint32_t y) { return x % 7 == 3 && y % 5 == 2; }), 3);
  for (uint32_t seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    expectUpdatesTellAll(randomPatchwork(seed), seed);
  }
}

TEST(MeshUpdate, TellsAllOfColoursAndNormals) {
  expectUpdatesTellAll(withColoursAndNormals(torus(30, 20), true, false), 4);
  expectUpdatesTellAll(withColoursAndNormals(torus(30, 20), false, true), 5);
  expectUpdatesTellAll(withColoursAndNormals(gridPatch(20, 20), true, true), 6);
}

TEST(MeshUpdate, NamesWhatWasBorn) {
  const RecordsAtHand records(encodedContent(torus(30, 20)));
  auto mesh = SelectivelyRefinedMesh::fromBase(records.base()).value();
  NodeIndex root = 0;
  while (mesh.isLeaf(root)) ++root;
  (void)mesh.takeUpdate();
  ASSERT_TRUE(records.split(mesh, root));
  const VertexSlot right = mesh.slot(mesh.leftChild(root) + 1);
  MeshUpdate update = mesh.takeUpdate();
  EXPECT_EQ(update.born, std::vector<uint32_t>{right});
  // The changes are those of the split and its neighbours, not the mesh.
  EXPECT_LT(update.slots.size(), mesh.positions().size());
  EXPECT_LT(update.faces.size(), mesh.drawnCorners().size());

  mesh.collapse(root);
  EXPECT_TRUE(mesh.takeUpdate().born.empty());
  ASSERT_TRUE(mesh.resplit(root));
  mesh.collapse(root);
  EXPECT_TRUE(mesh.takeUpdate().born.empty());  // it came and went
  mesh.stopUpdates();
  ASSERT_TRUE(mesh.resplit(root));
  update = mesh.takeUpdate();
  EXPECT_TRUE(update.born.empty());
  EXPECT_EQ(update.corners.size(), mesh.drawnCorners().size());
}

TEST(MeshUpdate, SlidesFromWhereItWasDrawn) {
  // A right child that is split before it is drawn leaves its own left child in its place.
  const RecordsAtHand records(encodedContent(sphere(4)));
  auto mesh = SelectivelyRefinedMesh::fromBase(records.base()).value();
  (void)mesh.takeUpdate();
  for (NodeIndex node = 0; node < mesh.nodeCount(); ++node) {
    if (mesh.isLeaf(node)) continue;
    ASSERT_TRUE(records.split(mesh, node));
    const NodeIndex right = mesh.leftChild(node) + 1;
    if (mesh.isLeaf(right)) continue;
    ASSERT_TRUE(records.split(mesh, right));
    const VertexSlot slot = mesh.slot(mesh.leftChild(right));
    const MeshUpdate update = mesh.takeUpdate();
    const auto at = std::lower_bound(update.slots.begin(), update.slots.end(), slot);
    ASSERT_TRUE(at != update.slots.end() && *at == slot);
    EXPECT_TRUE(std::binary_search(update.born.begin(), update.born.end(), slot));
    EXPECT_EQ(update.vertices[static_cast<size_t>(at - update.slots.begin())].from,
              mesh.position(node));
    return;
  }
  FAIL() << "no node to try it at";
}

}  // namespace
}  // namespace meshfront
