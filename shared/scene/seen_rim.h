// The rim of what is seen: vertices that cover no pixel, but have an edge to one that does, long
// enough to show.
//
// Triangles between a seen vertex and one behind the silhouette move when that one is split. Until
// it is, a few pixels along silhouettes are not the published mesh's, and a part that is finer next
// time, because another view has wanted it, shows vertices that were not seen before. Edges shorter
// than kRimEdgePixels count for nothing here: where triangles are smaller than pixels, as on a
// terrain seen whole, each split lays bare other vertices, until much is split that no picture
// shows.
//
// In a fine picture most of what is wrong lies along silhouettes: with the rim ranked beside what
// is seen, by its likely error, 48 dB of a mesh seen whole take 0.45 to 0.85 of the octets
// (tests/evaluation/quality). In a coarse picture it would cost: there the children of what is seen
// are worth more.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "shared/refinement/selectively_refined_mesh.h"

namespace meshfront {

inline constexpr double kRimEdgePixels = 2;
// The rim is ranked with what is seen, a level behind it, as soon as a seen vertex covers no more
// pixels than so many on average. A pixel counts for all corners of its triangle.
inline constexpr uint64_t kRimJoinsAtPixels = 30;
inline constexpr uint8_t kRimLevelsBehind = 1;

// What of a picture's pixels is of vertices that can still be split: active nodes that are no
// leaves.
struct SeenPixels {
  uint64_t all = 0;
  uint64_t open = 0;
  size_t nodes = 0;  // that cover a pixel, open or not
  size_t openNodes = 0;
};
// `pixels`: by vertex slot of `mesh`. O(slots).
[[nodiscard]] SeenPixels seenPixels(const SelectivelyRefinedMesh& mesh,
                                    std::span<const uint32_t> pixels);
[[nodiscard]] inline bool rimJoins(const SeenPixels& seen) {
  return seen.nodes > 0 && seen.all <= kRimJoinsAtPixels * seen.nodes;
}

// The rim's vertices that can still be split. `eye`, `pixelsAtOne`: as for liftByLikelyError()
// (likely_error.h); an edge is as long as it would be seen from the side. By slot. O(slots, and
// edges at what is seen).
[[nodiscard]] std::vector<VertexSlot> openRim(const SelectivelyRefinedMesh& mesh,
                                              std::span<const uint32_t> pixels,
                                              const glm::dvec3& eye, double pixelsAtOne);

}  // namespace meshfront
