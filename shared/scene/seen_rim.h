// The rim of what is seen: vertices that cover no pixel, but have an edge to one that does.
//
// Triangles between a seen vertex and one behind the silhouette move when that one is split. So a
// picture is that of the published mesh only when the rim is split, too; until then a few pixels
// along silhouettes are another triangle's, and a part that is finer next time, because another
// view has wanted it, shows vertices that were not seen before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/refinement/selectively_refined_mesh.h"

namespace meshfront {

// What of a picture's pixels is of vertices that can still be split: active nodes that are no
// leaves.
struct SeenPixels {
  uint64_t all = 0;
  uint64_t open = 0;
  size_t openNodes = 0;
};
// `pixels`: by vertex slot of `mesh`. O(slots).
[[nodiscard]] SeenPixels seenPixels(const SelectivelyRefinedMesh& mesh,
                                    std::span<const uint32_t> pixels);

// The rim's vertices that can still be split. O(edges).
[[nodiscard]] std::vector<VertexSlot> openRim(const SelectivelyRefinedMesh& mesh,
                                              std::span<const uint32_t> pixels);

}  // namespace meshfront
