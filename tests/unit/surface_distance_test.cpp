#include "tests/bench/surface_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/data/mesh_shapes.h"
#include "tests/data/nasty_meshes.h"

namespace meshfront {
namespace {

// The distance from a triangle by looking at many points of it: never too small, hardly too large.
double sampledDistance(const Point& p, const IndexedMesh& mesh) {
  constexpr int kSteps = 60;
  double best = 1e30;
  for (const Triangle& t : mesh.triangles) {
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        double sum = 0;
        for (size_t k = 0; k < 3; ++k) {
          const double at = (i * mesh.positions[t[0]][k] + j * mesh.positions[t[1]][k] +
                             (kSteps - i - j) * mesh.positions[t[2]][k]) /
                            kSteps;
          sum += (p[k] - at) * (p[k] - at);
        }
        best = std::min(best, std::sqrt(sum));
      }
    }
  }
  return best;
}

TEST(SurfaceDistance, IsThatOfTheNearestTriangle) {
  std::mt19937 random(1);
  const auto coordinate = [&] { return random() * 0x1p-31 - 0.5; };
  for (uint32_t seed = 0; seed < 5; ++seed) {
    const IndexedMesh mesh = randomSoup(seed, 30, 30);
    const TriangleTree tree(mesh.positions, mesh.triangles);
    for (int i = 0; i < 40; ++i) {
      const Point p = {coordinate(), coordinate(), coordinate()};
      const double sampled = sampledDistance(p, mesh);
      EXPECT_LE(tree.distance(p), sampled + 1e-12);
      EXPECT_GE(tree.distance(p), sampled - 0.03);
    }
  }
}

TEST(SurfaceDistance, MeasuresBothWays) {
  const IndexedMesh wide = gridPatch(4, 4);
  IndexedMesh raised = gridPatch(2, 4);  // half of it, half a step above
  for (Point& p : raised.positions) p[2] = 0.5;
  const TriangleTree wideTree(wide.positions, wide.triangles);
  const TriangleTree raisedTree(raised.positions, raised.triangles);
  const auto down = surfaceDistance(raised.positions, raised.triangles, wideTree, 1000);
  EXPECT_NEAR(down.mean, 0.5, 1e-12);
  EXPECT_NEAR(down.maximum, 0.5, 1e-12);
  const auto up = surfaceDistance(wide.positions, wide.triangles, raisedTree, 100000);
  EXPECT_NEAR(up.maximum, std::sqrt(4.25), 1e-12);
  // Half at 0.5; the mean of sqrt(x^2 + 1/4) over 0 .. 2 for the other half.
  const double other = (2 * std::sqrt(4.25) + 0.25 * std::asinh(4.0)) / 4;
  EXPECT_NEAR(up.mean, (0.5 + other) / 2, 1e-3);
}

}  // namespace
}  // namespace meshfront
