// Which front vertices to split next.
//
// Visual importance of a front vertex = pixels covered by its incident triangles (Cheng and Ooi
// 2008, section 4.2). The default order puts the significance level in front of it, because pixels
// alone spend most bytes on flat, well-covered parts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/refinement/selectively_refined_mesh.h"

namespace meshfront {

enum class RankOrder {
  significance,  // level ascending, then pixels descending
  pixels,        // pixels descending: the published order
};

struct Candidate {
  NodeIndex node = kNone;
  VertexSlot slot = kNone;
  uint32_t pixels = 0;
  uint8_t level = 0;  // as it is ranked
  NodeId id{};
};

// What a ranking goes by beside the pixels.
struct RankingBias {
  std::span<const uint8_t> lift{};  // levels that a vertex slot comes earlier; 0 beyond the span
  unsigned levelsBehind = 0;        // that all of the mesh comes later, in a scene of several
  size_t atMost = SIZE_MAX;         // nodes to ask for until the next ranking
  // Leaves out nodes whose records the mesh keeps: somebody else splits them again, by budgets
  // (refinement/front_budget.h).
  bool withoutKept = false;
};

// Total order. Ties fall to the node that comes first in preorder: equal views ask for equal sets,
// and neighbours in the hierarchy, which cost the fewest bits, are asked for together.
[[nodiscard]] bool ranksBefore(RankOrder order, const Candidate& a, const Candidate& b);

// Active, no leaf, `excluded[node]` not set (nodes beyond the span are not).
// Visible ones: pixels[slot] > 0 (slots beyond the span count 0). By slot, with biased levels.
[[nodiscard]] std::vector<Candidate> visibleCandidates(const SelectivelyRefinedMesh& mesh,
                                                       std::span<const uint32_t> pixels,
                                                       std::span<const uint8_t> excluded,
                                                       const RankingBias& bias = {});
// All of them, visible or not, with 0 pixels. By slot.
[[nodiscard]] std::vector<Candidate> allCandidates(const SelectivelyRefinedMesh& mesh,
                                                   std::span<const uint8_t> excluded);

// Leaves the `count` first ones by `order`, sorted. O(n + count log count).
void keepFirst(std::vector<Candidate>& candidates, size_t count, RankOrder order);

}  // namespace meshfront
