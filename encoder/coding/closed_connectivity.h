// Twins and rings of the closed input mesh, and who creates each of its faces.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "encoder/hierarchy/vertex_forest.h"
#include "shared/codec/ring_cut.h"
#include "shared/mesh/indexed_mesh.h"

namespace meshfront {

// Half-edge 3 f + i runs from corner i to corner i + 1 of face f.
[[nodiscard]] std::vector<uint32_t> twinsOf(std::span<const Triangle> triangles,
                                            uint32_t vertexCount);

// Every face is created by one split, the deepest lowest common ancestor of two of its corners, or
// belongs to the base mesh.
struct FaceOrigins {
  std::vector<ForestNode> creator;  // by face; kNoNode for a base face
  std::vector<uint32_t> leftFace;   // by split node - leafCount: its f_l = (u, t, l)
  std::vector<uint32_t> rightFace;  // likewise f_r = (u, r, t)
  std::vector<uint32_t> baseFaces;  // faces of the base mesh
};
[[nodiscard]] FaceOrigins faceOrigins(std::span<const Triangle> triangles,
                                      const VertexForest& forest);

}  // namespace meshfront
