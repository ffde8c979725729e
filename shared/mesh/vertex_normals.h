// Smooth normals from integer positions, area-weighted. The sums are integers: the same triangles
// give the same normals in whatever order they lie, so the streamed mesh is shaded exactly as the
// reference mesh.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/mesh/indexed_mesh.h"
#include "shared/mesh/quantization.h"

namespace meshfront {

// A unit vector in 16-bit steps of 1/32767; the fourth is padding. Zero for a vertex without area.
using PackedNormal = std::array<int16_t, 4>;

// One a position. Triangles with a corner out of range are skipped. `normals` is reused storage.
void computeVertexNormals(std::span<const GridPosition> positions,
                          std::span<const Triangle> corners, std::vector<PackedNormal>& normals);

// What computeVertexNormals() is made of, for those who follow a mesh that changes: the sum of a
// vertex's triangles, modulo 2^64, and the normal that it stands for.
using NormalSum = std::array<uint64_t, 3>;
// The triangle's normal, twice its area long; the same whichever corner comes first.
[[nodiscard]] NormalSum areaNormal(const GridPosition& p, const GridPosition& q,
                                   const GridPosition& r);
[[nodiscard]] PackedNormal packNormalSum(const NormalSum& sum);
// A vector of unit length, as vertices carry them.
[[nodiscard]] PackedNormal packUnitNormal(const std::array<float, 3>& normal);

}  // namespace meshfront
