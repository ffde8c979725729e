// The properties the system stands on, on meshes that are hard to get right: every front is the
// same in whatever order it is reached, and the full front is the input.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "encoder/cleaning/close_mesh.h"
#include "encoder/pack_tool/refinement_order.h"
#include "encoder/pack_tool/verify_pack.h"
#include "shared/store/pack_store.h"
#include "tests/data/mesh_shapes.h"
#include "tests/data/nasty_meshes.h"
#include "tests/unit/encoded_mesh.h"

namespace meshfront {
namespace {

GridMesh expectedOf(const IndexedMesh& mesh, unsigned bits) {
  CleaningReport report;
  const ClosedMesh closed = closeMesh(mesh, report).value();
  const Quantization grid = quantizationFor(closed.positions, bits);
  GridMesh out;
  for (const auto& p : closed.positions) out.positions.push_back(grid.toGrid(p));
  out.triangles.assign(closed.triangles.begin(),
                       closed.triangles.begin() + static_cast<ptrdiff_t>(closed.realTriangleCount));
  out.layout.colours = !closed.colours.empty();
  out.layout.normalBits = closed.normals.empty() ? 0 : kDefaultNormalBits;
  out.attributes = packAttributes(closed.colours, closed.normals, out.layout);
  return out;
}

void expectExact(const IndexedMesh& mesh, unsigned bits, unsigned orders) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("meshfront-any-order-" + std::to_string(getpid()) + ".pack");
  ASSERT_TRUE(writePack(path, encodedContent(mesh, bits)));
  {
    PackStore store(Pack::open(path).value(), std::make_shared<MemoryBudget>(size_t{1} << 28));
    const auto results = verifyOrders(store, expectedOf(mesh, bits), orders, {});
    ASSERT_TRUE(results) << results.error().message;
    for (const OrderResult& result : *results)
      EXPECT_TRUE(result.exact()) << result.order << ", seed " << result.seed;
  }
  std::filesystem::remove(path);
}

TEST(AnyOrder, NastyMeshesAreExact) {
  for (const NastyMesh& nasty : nastyMeshes()) {
    if (nasty.vanishes) continue;
    SCOPED_TRACE(nasty.name);
    expectExact(nasty.mesh, 10, kOrderKinds);
  }
}

TEST(AnyOrder, RandomSoupsAreExact) {
  for (uint32_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    const IndexedMesh soup = randomSoup(seed, 6 + seed % 40, 10 + 3 * seed);
    CleaningReport report;
    if (!closeMesh(soup, report)) continue;
    expectExact(soup, kMinQuantizationBits + seed % 13, 4);
  }
}

TEST(AnyOrder, AllGridsAreExact) {
  for (unsigned bits = kMinQuantizationBits; bits <= kMaxQuantizationBits; ++bits) {
    SCOPED_TRACE(bits);
    expectExact(torus(24, 12), bits, 3);
  }
}

TEST(AnyOrder, CollapsingEverythingGivesTheBaseBack) {
  const RecordsAtHand records(encodedContent(torus(30, 20)));
  auto mesh = SelectivelyRefinedMesh::fromBase(records.base()).value();
  const auto before = mesh.snapshot();
  std::vector<NodeIndex> splits;
  for (NodeIndex node = 0; node < mesh.nodeCount(); ++node) {
    if (mesh.isLeaf(node)) continue;
    ASSERT_TRUE(records.split(mesh, node));
    splits.push_back(node);
  }
  EXPECT_TRUE(mesh.complete());
  EXPECT_EQ(mesh.recordsHeld(), mesh.splitCount());
  for (size_t i = splits.size(); i-- > 0;) {
    ASSERT_TRUE(mesh.canCollapse(splits[i]));
    mesh.collapse(splits[i]);
  }
  EXPECT_EQ(mesh.splitsApplied(), 0U);
  const auto after = mesh.snapshot();
  EXPECT_EQ(after.positions, before.positions);
  EXPECT_EQ(after.triangles.size(), before.triangles.size());
}

TEST(AnyOrder, RefusesWhatIsNotSplittable) {
  const RecordsAtHand records(encodedContent(torus(30, 20)));
  auto mesh = SelectivelyRefinedMesh::fromBase(records.base()).value();
  NodeIndex root = 0;
  while (mesh.isLeaf(root)) ++root;
  EXPECT_FALSE(mesh.resplit(root));  // no record yet
  ASSERT_TRUE(records.split(mesh, root));
  EXPECT_FALSE(records.split(mesh, root));  // not active any more
  EXPECT_FALSE(mesh.find(NodeId::root(1U << 30)));
  EXPECT_FALSE(mesh.find(mesh.id(root).child(false).child(true)));
}

}  // namespace
}  // namespace meshfront
