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

}  // namespace meshfront
