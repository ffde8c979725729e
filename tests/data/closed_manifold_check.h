// The judge of what cleaning promises, written for plainness rather than speed.
#pragma once

#include <span>
#include <string>

#include "shared/mesh/indexed_mesh.h"

namespace meshfront {

// Empty if the triangles form a closed, oriented, simplicial 2-manifold on vertices
// 0 .. vertexCount - 1: every directed edge once and its reverse once, the faces at each vertex one
// closed fan, no two faces on the same three vertices, no vertex unused. Else what is wrong first.
[[nodiscard]] std::string whyNotClosedManifold(size_t vertexCount,
                                               std::span<const Triangle> triangles);

}  // namespace meshfront
