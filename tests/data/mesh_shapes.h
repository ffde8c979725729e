// Plain shapes to build test meshes from.
#pragma once

#include <functional>

#include "shared/mesh/indexed_mesh.h"

namespace meshfront {

// columns x rows squares of two triangles, in the plane z = 0, side 1, facing up.
[[nodiscard]] IndexedMesh gridPatch(uint32_t columns, uint32_t rows);
// gridPatch without the squares that `hole(column, row)` names; its vertices all stay.
[[nodiscard]] IndexedMesh gridPatchWithout(uint32_t columns, uint32_t rows,
                                           const std::function<bool(uint32_t, uint32_t)>& hole);
[[nodiscard]] IndexedMesh tetrahedron();
// Closed, around the z axis; around and tube are at least 3.
[[nodiscard]] IndexedMesh torus(uint32_t around, uint32_t tube);
// An octahedron refined `times` times, on the unit sphere: 4^times * 4 + 2 vertices.
[[nodiscard]] IndexedMesh sphere(unsigned times);
// The surface of a set of unit cubes within size[0] x size[1] x size[2], facing out. Not manifold
// where cubes touch in an edge or corner only.
[[nodiscard]] IndexedMesh cubesSurface(
    const std::array<int, 3>& size, const std::function<bool(const std::array<int, 3>&)>& filled);

// Appends `part`, moved by `offset`, sharing no vertices.
void appendMesh(IndexedMesh& mesh, const IndexedMesh& part, const std::array<double, 3>& offset);

}  // namespace meshfront
