// Simplification by half-edge collapses: from the full mesh down to a small base, as a log that a
// vertex hierarchy is built from. Every collapse moves one vertex onto a neighbour; no position is
// ever made up.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "shared/mesh/indexed_mesh.h"
#include "shared/mesh/quantization.h"

namespace meshfront {

struct Collapse {
  uint32_t kept;
  uint32_t removed;
};

struct SimplifyOptions {
  // Wanted size of the base as a share of the real vertices, 0 .. 1; never fewer than 4 vertices.
  double baseFraction = 0.002;
  // p of (1 + height of the taller child tree)^p, the factor on a collapse's error: 0, 1 or 2 (more
  // is taken as 2). Larger makes shallower trees and a slightly worse mesh.
  unsigned balance = 1;
  // A vertex with more neighbours than this is not removed, as moving it looks at all of them; up
  // to kLargestMaxValence (more is taken as that).
  uint32_t maxValence = 64;
};
inline constexpr uint32_t kLargestMaxValence = 1000;

enum class StopReason {
  reachedBase,      // as few vertices as asked for
  noValidCollapse,  // the rules refused everything that was left; EndState says which
  notClosed,        // the input broke the precondition; there is no log
};

// The mesh at which simplification got stuck: all directions in which a real vertex that is left
// could go, by the rule that refuses them; several may. Zero unless it did get stuck.
struct EndState {
  uint64_t directions = 0;
  uint64_t smallestComponent = 0;  // between the vertices of a tetrahedron; these by no other rule
  uint64_t virtualVertex = 0;      // onto the vertex that closes a hole
  uint64_t link = 0;               // would pinch the surface: handles, and holes of three edges
  uint64_t depth = 0;              // the tree would be deeper than kMaxDepth
  uint64_t valence = 0;            // more neighbours than SimplifyOptions::maxValence
  uint64_t depthAlone = 0;         // of these, the ones that no other rule refuses
  uint64_t valenceAlone = 0;
  uint32_t valenceNeeded = 0;  // the smallest maxValence that would let one of those go, or 0
  // Collapses keep the topology, so these are the whole mesh's, holes closed.
  uint64_t components = 0;
  uint64_t smallestComponents = 0;  // down to four vertices, the virtual one of a hole included
  uint64_t handles = 0;             // as of a torus
};

struct SimplifyReport {
  StopReason why = StopReason::reachedBase;
  uint32_t wantedVertices = 0;  // the goal, real vertices
  uint32_t baseVertices = 0;    // what is left, real vertices
  unsigned maxHeight = 0;       // of the tallest tree, in splits
  // How often a rule refused a direction that a vertex would have liked best. A direction may be
  // refused again each time its vertex comes up.
  uint64_t refusedByLink = 0;
  uint64_t refusedByDepth = 0;
  uint64_t refusedByValence = 0;  // vertices with more neighbours than maxValence
  uint64_t refusedVirtual = 0;
  uint64_t postponedFlips = 0;  // would turn a face over: left until nothing else remained
  uint64_t acceptedFlips = 0;   // collapses made although they turn a face over
  EndState endState;
  double seconds = 0;
};

struct Simplification {
  std::vector<Collapse> collapses;  // input vertex indices, in the order collapsed: finest first
  SimplifyReport report;
};

// Done so far and planned; called about every 16,384 collapses from the calling thread.
using SimplifyProgress = std::function<void(size_t done, size_t planned)>;

// `triangles` is a closed, oriented, simplicial 2-manifold: every edge in exactly two triangles of
// opposite direction, no two edges on the same pair of vertices, one fan a vertex. Vertices
// 0 .. positions.size() - 1 are real, the virtualCount after them are virtual and never collapsed
// in either role. The first realTriangleCount triangles have real corners only, all others one
// virtual corner. Faces may have no area, and positions may coincide.
//
// The cost of moving u onto t is u's area-weighted quadric error (Garland and Heckbert, SIGGRAPH
// 1997; summed over all that has been collapsed onto u) at t's position plus 1e-7 |ut|^4, times the
// balance factor. Area times squared distance is a length to the fourth too, so the sum means the
// same at any scale; |ut| counts as one grid step at least. What is already on t would be lost in
// either case and stays out: with it the mean distance at a fifth of the vertices is 2 % larger.
// Boundary edges add planes perpendicular to their faces. The result is the same on every machine.
//
// Peak memory: about 184 bytes a vertex, the input aside (36). Time: about n log n.
[[nodiscard]] Simplification simplify(std::span<const GridPosition> positions,
                                      uint32_t virtualCount, std::span<const Triangle> triangles,
                                      size_t realTriangleCount, const SimplifyOptions& options,
                                      const SimplifyProgress& progress = {});

}  // namespace meshfront
