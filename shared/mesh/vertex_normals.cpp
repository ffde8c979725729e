#include "shared/mesh/vertex_normals.h"

#include <algorithm>
#include <cmath>

namespace meshfront {
namespace {

int16_t packed(double component) {
  return static_cast<int16_t>(std::lround(component * 32767));
}

}  // namespace

// Coordinates have at most 20 bits, so a cross product has at most 42 and four million triangles
// may meet at one vertex. Sums are taken unsigned: wrapping around beyond that is defined.
NormalSum areaNormal(const GridPosition& p, const GridPosition& q, const GridPosition& r) {
  std::array<int64_t, 3> a{};
  std::array<int64_t, 3> b{};
  for (size_t i = 0; i < 3; ++i) {
    a[i] = int64_t{q[i]} - p[i];
    b[i] = int64_t{r[i]} - p[i];
  }
  return {static_cast<uint64_t>(a[1] * b[2] - a[2] * b[1]),
          static_cast<uint64_t>(a[2] * b[0] - a[0] * b[2]),
          static_cast<uint64_t>(a[0] * b[1] - a[1] * b[0])};
}

PackedNormal packNormalSum(const NormalSum& sum) {
  const auto x = static_cast<double>(static_cast<int64_t>(sum[0]));
  const auto y = static_cast<double>(static_cast<int64_t>(sum[1]));
  const auto z = static_cast<double>(static_cast<int64_t>(sum[2]));
  const double length = std::sqrt(x * x + y * y + z * z);
  if (!(length > 0)) return {};
  return {packed(x / length), packed(y / length), packed(z / length), 0};
}

PackedNormal packUnitNormal(const std::array<float, 3>& normal) {
  return {packed(double{normal[0]}), packed(double{normal[1]}), packed(double{normal[2]}), 0};
}

void computeVertexNormals(std::span<const GridPosition> positions,
                          std::span<const Triangle> corners, std::vector<PackedNormal>& normals) {
  std::vector<NormalSum> sums(positions.size());
  for (const Triangle& corner : corners) {
    if (corner[0] == corner[1] || std::max({corner[0], corner[1], corner[2]}) >= positions.size()) {
      continue;  // undrawn slots first of all
    }
    const NormalSum normal =
        areaNormal(positions[corner[0]], positions[corner[1]], positions[corner[2]]);
    for (const uint32_t vertex : corner)
      for (size_t i = 0; i < 3; ++i) sums[vertex][i] += normal[i];
  }
  normals.clear();
  normals.reserve(sums.size());
  for (const NormalSum& sum : sums) normals.push_back(packNormalSum(sum));
}

}  // namespace meshfront
