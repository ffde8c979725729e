// The whole way on random meshes: encode, split every node in a random order, and compare with the
// input itself, not with what cleaning made of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "shared/mesh/same_triangles.h"
#include "tests/data/nasty_meshes.h"
#include "tests/unit/encoded_mesh.h"

namespace meshfront {
namespace {

struct PlacedTriangles {
  std::vector<GridPosition> positions;
  std::vector<Triangle> triangles;
};

// The different triangles of an input (three different places; each orientation once) on a grid.
PlacedTriangles differentTriangles(const IndexedMesh& mesh, const Quantization& grid) {
  std::set<std::array<std::array<double, 3>, 3>> seen;
  PlacedTriangles out;
  for (const Triangle& t : mesh.triangles) {
    std::array<std::array<double, 3>, 3> placed = {mesh.positions[t[0]], mesh.positions[t[1]],
                                                   mesh.positions[t[2]]};
    if (placed[0] == placed[1] || placed[1] == placed[2] || placed[2] == placed[0]) continue;
    std::rotate(placed.begin(), std::min_element(placed.begin(), placed.end()), placed.end());
    if (!seen.insert(placed).second) continue;
    const auto first = static_cast<uint32_t>(out.positions.size());
    for (const auto& p : placed) out.positions.push_back(grid.toGrid(p));
    out.triangles.push_back({first, first + 1, first + 2});
  }
  return out;
}

void expectExactInRandomOrder(const IndexedMesh& mesh, uint32_t seed, unsigned bits) {
  EncodeOptions options;
  options.name = "test";
  options.quantizationBits = bits;
  options.baseFraction = 0.01;
  options.balance = seed % 3;
  auto encoded = encodeMesh(mesh, options);
  ASSERT_TRUE(encoded) << encoded.error().message;
  const RecordsAtHand records(std::move(encoded->pack));
  auto decoded = SelectivelyRefinedMesh::fromBase(records.base());
  ASSERT_TRUE(decoded) << decoded.error().message;

  std::mt19937 random(seed);
  std::vector<NodeIndex> splittable;
  const auto add = [&](NodeIndex node) {
    if (!decoded->isLeaf(node)) splittable.push_back(node);
  };
  for (NodeIndex node = 0; node < decoded->nodeCount(); ++node) add(node);
  while (!splittable.empty()) {
    std::swap(splittable[random() % splittable.size()], splittable.back());
    const NodeIndex node = splittable.back();
    splittable.pop_back();
    const auto done = records.split(*decoded, node);
    ASSERT_TRUE(done) << done.error().message;
    add(decoded->leftChild(node));
    add(decoded->leftChild(node) + 1);
  }
  EXPECT_TRUE(decoded->complete());
  const auto got = decoded->snapshot();
  const auto expected = differentTriangles(mesh, records.content().metadata.quantization);
  EXPECT_GT(expected.triangles.size(), 0U);
  const auto difference =
      compareTriangles(got.positions, got.triangles, expected.positions, expected.triangles);
  EXPECT_EQ(difference.missingInFirst, 0U);
  EXPECT_EQ(difference.missingInSecond, 0U);
}

TEST(RandomMeshes, PatchworksAreExactInRandomOrder) {
  for (uint32_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    expectExactInRandomOrder(randomPatchwork(seed), seed, kMinQuantizationBits + seed % 13);
  }
}

TEST(RandomMeshes, SoupsOnFewVerticesAreExactInRandomOrder) {
  for (uint32_t seed = 1000; seed < 1100; ++seed) {
    SCOPED_TRACE(seed);
    const IndexedMesh soup = randomSoup(seed, 4 + seed % 17, 20 + seed % 60);
    expectExactInRandomOrder(soup, seed, kMinQuantizationBits + seed % 13);
  }
}

TEST(RandomMeshes, NastyMeshesAreExactInRandomOrder) {
  for (const NastyMesh& nasty : nastyMeshes()) {
    SCOPED_TRACE(nasty.name);
    if (!nasty.vanishes) expectExactInRandomOrder(nasty.mesh, 5, 14);
  }
}

TEST(RandomMeshes, AMeshThatVanishesIsACleanError) {
  size_t vanishing = 0;
  for (const NastyMesh& nasty : nastyMeshes()) {
    EXPECT_EQ(nasty.vanishes, nasty.name.starts_with("vanishes-"));
    if (!nasty.vanishes) continue;
    ++vanishing;
    EncodeOptions options;
    options.name = "test";
    const auto encoded = encodeMesh(nasty.mesh, options);
    ASSERT_FALSE(encoded);
    EXPECT_EQ(encoded.error().message,
              "cleaning: no triangle with three different corners is left");
  }
  EXPECT_EQ(vanishing, 2U);
}

}  // namespace
}  // namespace meshfront
