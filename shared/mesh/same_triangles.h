// Are two meshes the same triangles on the same grid positions? The order of vertices and
// triangles, the corner a triangle starts with and how vertices are shared do not matter;
// orientation does.
#pragma once

#include <cstddef>
#include <span>

#include "shared/mesh/grid_mesh.h"
#include "shared/mesh/indexed_mesh.h"
#include "shared/mesh/quantization.h"

namespace meshfront {

struct TriangleSetDifference {
  size_t missingInFirst = 0;   // triangles of the second that the first lacks, with multiplicity
  size_t missingInSecond = 0;  // and the other way round
  [[nodiscard]] bool equal() const { return missingInFirst == 0 && missingInSecond == 0; }
};

// Compares the multisets of oriented triangles, exactly. Requires: every index lies within its
// positions, every coordinate in 0 .. 2^21 - 1. Triangles that quantisation made degenerate count.
// O(n log n); 24 bytes of memory a triangle.
[[nodiscard]] TriangleSetDifference compareTriangles(std::span<const GridPosition> firstPositions,
                                                     std::span<const Triangle> firstTriangles,
                                                     std::span<const GridPosition> secondPositions,
                                                     std::span<const Triangle> secondTriangles);

// The same with what corners carry, if both meshes carry anything; 72 bytes a triangle then.
[[nodiscard]] TriangleSetDifference compareMeshes(const GridMesh& first, const GridMesh& second);

}  // namespace meshfront
