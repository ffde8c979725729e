// A mesh as it lies in memory, for drawing it whole.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/mesh/indexed_mesh.h"
#include "shared/mesh/quantization.h"
#include "shared/mesh/vertex_attributes.h"
#include "shared/refinement/mesh_update.h"
#include "shared/result.h"

namespace meshfront {

// The spans need to live only through the call that they are given to.
struct MeshArrays {
  Quantization quantization;
  std::span<const GridPosition> positions;  // by vertex slot
  std::span<const Triangle> corners;        // by face slot, vertex slots; all equal = not drawn
  uint64_t changeCount = 0;                 // equal = the arrays are as they were
  // By vertex slot, for their colours (sRGB and alpha); empty: the mesh has none.
  std::span<const VertexAttributes> coloured{};
  // By vertex slot, for the normals that the mesh carries, of so many bits; empty: it carries none,
  // and is shaded by its triangles.
  std::span<const VertexAttributes> normals{};
  unsigned normalBits = 0;
};

// As one update that makes up all of the mesh; every vertex a leaf of tree 0. A triangle with a
// corner out of range is an error, as are attributes that are not one a vertex.
[[nodiscard]] Result<MeshUpdate> updateFrom(const MeshArrays& mesh);

}  // namespace meshfront
