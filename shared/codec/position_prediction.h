// Where the right child of a split stands, predicted from the tangent plane at the split vertex.
// Integer arithmetic alone, so that every platform gets the same bits.
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "shared/mesh/indexed_mesh.h"
#include "shared/mesh/quantization.h"

namespace meshfront {

// A predicted normal, about kNormalLength long; never zero.
using PredictedNormal = std::array<int16_t, 3>;
inline constexpr int32_t kNormalLength = 1 << 14;

// The axis of the largest component (the first of equals); b and c follow it cyclically.
[[nodiscard]] inline unsigned mainAxis(const PredictedNormal& normal) {
  const std::array<int, 3> size{std::abs(normal[0]), std::abs(normal[1]), std::abs(normal[2])};
  const unsigned axis = size[1] > size[0] ? 1 : 0;
  return size[2] > size[axis] ? 2 : axis;
}

// The d_a that makes d perpendicular to the normal, rounded to nearest, halves away from zero.
[[nodiscard]] int32_t predictedAlong(const PredictedNormal& normal, unsigned axis, int32_t deltaB,
                                     int32_t deltaC);

// The normal of both children: what is left of `normal` when its part along d is taken out,
// renormalised; unchanged where less than a fifth would be left or d is zero.
[[nodiscard]] PredictedNormal normalAfter(const PredictedNormal& normal, const GridPosition& delta);

// The area-weighted normals of base vertices; (0, 0, kNormalLength) where they vanish.
// Triangles with a corner >= positions.size() (virtual) count for nothing.
[[nodiscard]] std::vector<PredictedNormal> baseNormals(std::span<const GridPosition> positions,
                                                       std::span<const Triangle> triangles);

}  // namespace meshfront
