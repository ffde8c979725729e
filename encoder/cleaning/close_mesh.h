// Makes a closed, oriented, simplicial 2-manifold of any triangles, without moving a vertex or
// turning a face, so that the codec needs no special cases:
//  - every directed edge (a, b) occurs exactly once, and so does (b, a);
//  - the faces at every vertex form exactly one closed fan (of at least three);
//  - no two faces share all three vertices, no two vertices are joined by two edges.
//
//   CleaningReport report;
//   auto closed = closeMesh(*readMesh("bunny.ply"), report);
//
// What is done, in this order:
//  1. vertices at exactly equal coordinates are welded; the first one's colour and normal stay;
//  2. faces with two equal corners, and faces that repeat an earlier one (same corners, same
//     orientation), are dropped; a face with the corners of an earlier one and the opposite
//     orientation goes to a second layer with vertices of its own (a sheet doubled back to back
//     thus becomes two sheets);
//  3. an edge stays joined only if exactly two faces use it, in opposite directions; any other is
//     cut: each of its faces has a boundary there;
//  4. each vertex with several fans of faces is copied, one vertex a fan;
//  5. where a cut left exactly two boundary edges between the same two vertices, they are joined
//     again (two solids that touched along an edge become closed again, each by itself);
//  6. each boundary loop (three or more edges, no vertex twice) is closed with triangles to one
//     virtual vertex;
//  7. vertices without faces are dropped.
// Copies of a vertex have its position, colour and normal.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shared/mesh/indexed_mesh.h"
#include "shared/result.h"

namespace meshfront {

// verticesIn - weldedVertices - unreferencedVertices + verticesSplit = ClosedMesh::positions.size()
// trianglesIn - degenerateFaces - repeatedFaces = ClosedMesh::realTriangleCount
struct CleaningReport {
  uint64_t verticesIn = 0;
  uint64_t trianglesIn = 0;
  uint64_t weldedVertices = 0;        // gone into another one at the same coordinates
  uint64_t weldedDifferently = 0;     // of those: with another colour or normal, which is lost
  uint64_t degenerateFaces = 0;       // dropped: two equal corners after welding
  uint64_t repeatedFaces = 0;         // dropped: the same corners and orientation as an earlier one
  uint64_t oppositeDuplicates = 0;    // kept, on vertices of the second layer
  uint64_t nonManifoldEdges = 0;      // cut: three or more faces
  uint64_t inconsistentEdges = 0;     // cut: two faces that use it in the same direction
  uint64_t rejoinedEdges = 0;         // pairs of cut edges joined again (step 5)
  uint64_t verticesSplit = 0;         // copies made, by steps 2 and 4
  uint64_t unreferencedVertices = 0;  // dropped: distinct positions that no kept face uses
  uint64_t boundaryLoops = 0;         // closed, one virtual vertex each
  uint64_t components = 0;            // connected by edges, when done
};

struct ClosedMesh {
  std::vector<std::array<double, 3>> positions;  // of the real vertices, 0 .. positions.size() - 1
  std::vector<Colour> colours;                   // empty or one a real vertex, as the input's
  std::vector<std::array<float, 3>> normals;     // likewise
  uint32_t virtualCount = 0;                     // the vertices behind those, one a boundary loop
  // The first realTriangleCount are the input's that were kept, in its order and each with its
  // first corner; the others close the loops, have one virtual corner, and are never drawn.
  std::vector<Triangle> triangles;
  size_t realTriangleCount = 0;

  [[nodiscard]] size_t vertexCount() const { return positions.size() + virtualCount; }
  [[nodiscard]] bool isVirtual(uint32_t vertex) const { return vertex >= positions.size(); }
};

// Deterministic; O(n log n), about 80 bytes of memory a triangle; uses the mesh up. An Error if an
// index is out of range, if there are neither none nor as many colours or normals as positions, if
// the coordinates lie further apart than the largest double, if no triangle is left, or (tooLarge)
// beyond 2^32 / 12 triangles. Fills `report` as far as it came in any case.
[[nodiscard]] Result<ClosedMesh> closeMesh(IndexedMesh mesh, CleaningReport& report);

}  // namespace meshfront
