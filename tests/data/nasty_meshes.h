// Small meshes that break careless code, for every test that takes a mesh. Made, not stored; the
// same on every machine.
#pragma once

#include <string>
#include <vector>

#include "shared/mesh/indexed_mesh.h"

namespace meshfront {

struct NastyMesh {
  std::string name;  // of letters, digits and dashes; "vanishes-..." if it does
  IndexedMesh mesh;
  bool vanishes = false;  // no triangle survives cleaning: an Error is the right answer
};

[[nodiscard]] std::vector<NastyMesh> nastyMeshes();

// A piece of a grid or a torus with some triangles flipped, deleted, repeated (also turned round)
// and some vertices glued, by index or position: locally a surface, with every kind of wound. At
// least one triangle stays.
[[nodiscard]] IndexedMesh randomPatchwork(uint32_t seed);

// `triangleCount` triangles with corners drawn from `vertexCount` (>= 1) vertices in the unit cube:
// edges with any number of faces, degenerate, repeated and opposite ones. With few vertices nearly
// everything is wrong, with many nearly everything is loose.
[[nodiscard]] IndexedMesh randomSoup(uint32_t seed, uint32_t vertexCount, uint32_t triangleCount);

}  // namespace meshfront
