// Nodes to be split whose records are at hand, in the order of their ranks.
#pragma once

#include <algorithm>
#include <vector>

#include "shared/receiver/ranking.h"

namespace meshfront {

// Rankings in a row that find something at hand, and so let no request out: a second of frames.
// Then requests go out beside the plans.
inline constexpr unsigned kMostPlansInRow = 64;

class SplitPlan {
  [[nodiscard]] auto later() const {
    return [order = order_](const Candidate& a, const Candidate& b) {
      return ranksBefore(order, b, a);
    };
  }

 public:
  explicit SplitPlan(RankOrder order) : order_(order) {}

  void add(const Candidate& candidate) {
    heap_.push_back(candidate);
    std::push_heap(heap_.begin(), heap_.end(), later());
  }
  // Requires !empty().
  Candidate takeFirst() {
    std::pop_heap(heap_.begin(), heap_.end(), later());
    const Candidate first = heap_.back();
    heap_.pop_back();
    return first;
  }
  [[nodiscard]] bool empty() const { return heap_.empty(); }
  void clear() { heap_.clear(); }

 private:
  const RankOrder order_;
  std::vector<Candidate> heap_;
};

// A child of a node that has just been split, as far as the last count tells: it shows half of what
// its parent showed. At 0 pixels only a new count can tell.
[[nodiscard]] inline Candidate childCandidate(const SelectivelyRefinedMesh& mesh,
                                              const Candidate& parent, NodeIndex child) {
  // The parent's level may be biased; the difference is not.
  const unsigned level = parent.level + mesh.level(child) - mesh.level(parent.node);
  return {child, mesh.slot(child), parent.pixels / 2, static_cast<uint8_t>(std::min(level, 255U)),
          mesh.id(child)};
}

}  // namespace meshfront
