// The order in which a verification splits the front: what a receiver might do, and worse.
#pragma once

#include <cstdint>
#include <queue>
#include <random>
#include <string>
#include <vector>

#include "shared/refinement/selectively_refined_mesh.h"

namespace meshfront {

enum class OrderKind {
  uniformRandom,
  regionFirst,    // nearest to a random vertex first
  depthFirst,     // newest first
  largestDelta,   // most moved by its parent's split first
  breadthFirst,   // oldest first
  significance,   // coarse levels first
  finestFirst,    // the opposite
  randomSubtree,  // random among the newest few
};
inline constexpr unsigned kOrderKinds = 8;
[[nodiscard]] std::string nameOf(OrderKind kind);

// The splittable front vertices, best first.
class RefinementOrder {
 public:
  RefinementOrder(OrderKind kind, uint64_t seed, const SelectivelyRefinedMesh& mesh);
  void add(NodeIndex node);  // active, no leaf, not in the order now
  [[nodiscard]] bool empty() const { return queue_.empty(); }
  NodeIndex takeFirst();

 private:
  [[nodiscard]] double keyOf(NodeIndex node);
  struct Entry {
    double key;
    NodeIndex node;
    bool operator<(const Entry& other) const {  // smaller key first
      return key != other.key ? key > other.key : node > other.node;
    }
  };
  OrderKind kind_;
  const SelectivelyRefinedMesh& mesh_;
  std::mt19937_64 random_;
  GridPosition centre_{};
  double counter_ = 0;
  std::priority_queue<Entry> queue_;
};

}  // namespace meshfront
