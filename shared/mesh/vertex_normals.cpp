#include "shared/mesh/vertex_normals.h"

#include <algorithm>
#include <cmath>

namespace meshfront {
namespace {

// Coordinates have at most 20 bits, so a cross product has at most 42 and four million triangles
// may meet at one vertex. Sums are taken unsigned: wrapping around beyond that is defined.
using Sum = std::array<uint64_t, 3>;

int16_t packed(double component) {
  return static_cast<int16_t>(std::lround(component * 32767));
}

}  // namespace

void computeVertexNormals(std::span<const GridPosition> positions,
                          std::span<const Triangle> corners, std::vector<PackedNormal>& normals) {
  std::vector<Sum> sums(positions.size());
  for (const Triangle& corner : corners) {
    if (corner[0] == corner[1] || std::max({corner[0], corner[1], corner[2]}) >= positions.size()) {
      continue;  // undrawn slots first of all
    }
    const GridPosition& p = positions[corner[0]];
    const GridPosition& q = positions[corner[1]];
    const GridPosition& r = positions[corner[2]];
    std::array<int64_t, 3> a{};
    std::array<int64_t, 3> b{};
    for (size_t i = 0; i < 3; ++i) {
      a[i] = int64_t{q[i]} - p[i];
      b[i] = int64_t{r[i]} - p[i];
    }
    const std::array<int64_t, 3> cross = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                                          a[0] * b[1] - a[1] * b[0]};
    for (const uint32_t vertex : corner) {
      for (size_t i = 0; i < 3; ++i) {
        sums[vertex][i] += static_cast<uint64_t>(cross[i]);
      }
    }
  }
  normals.assign(positions.size(), PackedNormal{});
  for (size_t v = 0; v < sums.size(); ++v) {
    const auto x = static_cast<double>(static_cast<int64_t>(sums[v][0]));
    const auto y = static_cast<double>(static_cast<int64_t>(sums[v][1]));
    const auto z = static_cast<double>(static_cast<int64_t>(sums[v][2]));
    const double length = std::sqrt(x * x + y * y + z * z);
    if (length > 0) {
      normals[v] = {packed(x / length), packed(y / length), packed(z / length), 0};
    }
  }
}

}  // namespace meshfront
