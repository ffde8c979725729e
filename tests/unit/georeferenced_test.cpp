// Coordinates of a national grid in double precision: nothing may be lost before quantisation.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>

#include "shared/mesh_files/mesh_files.h"
#include "shared/store/pack.h"
#include "tests/data/temporary_folder.h"
#include "tests/unit/encoded_mesh.h"

namespace meshfront {
namespace {

constexpr int64_t kEast = 500000123;  // millimetres
constexpr int64_t kNorth = 4649776224;
constexpr int64_t kHeight = 1234567;
constexpr int kSteps = 16383;  // of one millimetre: the grid of 14 bits

std::string metres(int64_t millimetres) {
  std::string fraction = std::to_string(millimetres % 1000);
  fraction.insert(0, 3 - fraction.size(), '0');
  return std::to_string(millimetres / 1000) + "." + fraction;
}

// A square of kSteps millimetres, its inner vertices on millimetres that a float cannot tell apart
// (near 4,649,776 floats are 500 mm apart).
std::vector<GridPosition> latticePoints() {
  constexpr int kSide = 24;
  std::vector<GridPosition> points;
  for (int y = 0; y <= kSide; ++y) {
    for (int x = 0; x <= kSide; ++x) {
      const auto along = [](int i, int wobble) {
        return i == 0 ? 0 : i == kSide ? kSteps : i * (kSteps / kSide) + wobble;
      };
      points.push_back({along(x, (x * 37 + y * 11) % 101), along(y, (x * 53 + y * 29) % 97),
                        (x * 71 + y * 41) % 600});
    }
  }
  return points;
}

std::string asciiPly(const std::vector<GridPosition>& points) {
  const auto side = static_cast<int>(std::lround(std::sqrt(double(points.size()))));
  std::string vertices;
  for (const GridPosition& p : points)
    vertices +=
        metres(kEast + p[0]) + " " + metres(kNorth + p[1]) + " " + metres(kHeight + p[2]) + "\n";
  std::string faces;
  for (int y = 0; y + 1 < side; ++y)
    for (int x = 0; x + 1 < side; ++x) {
      const int corner = y * side + x;
      faces += "4 " + std::to_string(corner) + " " + std::to_string(corner + 1) + " " +
               std::to_string(corner + side + 1) + " " + std::to_string(corner + side) + "\n";
    }
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(points.size()) +
         "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
         std::to_string((side - 1) * (side - 1)) +
         "\nproperty list uchar int vertex_indices\nend_header\n" + vertices + faces;
}

TEST(Georeferenced, ComesBackAtTheExactGridPoints) {
  const TemporaryFolder folder;
  const auto points = latticePoints();
  std::ofstream(folder / "site.ply") << asciiPly(points);
  EncodeOptions options;
  options.name = "site";
  auto encoded = encodeFile(folder / "site.ply", options);
  ASSERT_TRUE(encoded) << encoded.error().message;
  // Through the pack's metadata on disk, which must keep the doubles.
  const Quantization before = encoded->pack.metadata.quantization;
  PackContent content = encoded->pack;
  const RecordsAtHand records(std::move(encoded->pack));
  ASSERT_TRUE(writePack(folder / "site.pack", std::move(content)));
  const Quantization grid = Pack::open(folder / "site.pack").value()->metadata().quantization;
  EXPECT_EQ(grid.origin, before.origin);
  EXPECT_EQ(grid.step, before.step);
  EXPECT_EQ(grid.origin[0], 500000.123);
  EXPECT_EQ(grid.origin[1], 4649776.224);
  EXPECT_EQ(grid.bits, 14U);
  EXPECT_NEAR(grid.step, 0.001, 1e-12);

  auto mesh = SelectivelyRefinedMesh::fromBase(records.base()).value();
  for (NodeIndex node = 0; node < mesh.nodeCount(); ++node) {
    if (mesh.isLeaf(node)) continue;
    ASSERT_TRUE(records.split(mesh, node));
  }
  const auto got = mesh.snapshot();
  EXPECT_EQ(std::multiset<GridPosition>(got.positions.begin(), got.positions.end()),
            std::multiset<GridPosition>(points.begin(), points.end()));
  // And back in the world each is within a thousandth of a step of where it was.
  for (const GridPosition& p : got.positions) {
    const auto world = grid.toWorld(p);
    EXPECT_NEAR(world[0], double(kEast + p[0]) / 1000, 1e-6);
    EXPECT_NEAR(world[1], double(kNorth + p[1]) / 1000, 1e-6);
    EXPECT_NEAR(world[2], double(kHeight + p[2]) / 1000, 1e-6);
  }
}

}  // namespace
}  // namespace meshfront
