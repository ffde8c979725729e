// The nodes that a request means, in the order of its answer: each wanted node, then the
// descendants that its expansion adds. One walk for all stores.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/codec/answer.h"
#include "shared/hierarchy/node_id.h"

namespace meshfront {

// What a node's record tells about the node's children.
struct ChildFacts {
  bool leftIsLeaf = false;
  bool rightIsLeaf = false;
  uint8_t leftLevel = 0;  // of no meaning for a leaf
  uint8_t rightLevel = 0;

  [[nodiscard]] bool isLeaf(bool right) const { return right ? rightIsLeaf : leftIsLeaf; }
  [[nodiscard]] uint8_t level(bool right) const { return right ? rightLevel : leftLevel; }
};

// What is left of an expansion one generation below.
[[nodiscard]] inline Expansion oneGenerationBelow(const Expansion& expansion) {
  Expansion below = expansion;
  if (below.levels > 0) --below.levels;
  return below;
}

[[nodiscard]] inline bool reaches(const Expansion& expansion, unsigned childLevel) {
  return expansion.significance ? childLevel <= *expansion.significance : expansion.levels > 0;
}

// Calls std::optional<ChildFacts> visit(node, expansion from there on) for each node; nothing
// returned = do not go below it. The walk ends early once stopped() after a visit.
template <typename Visit, typename Stopped>
void walkRequest(std::span<const NodeId> wanted, const Expansion& expansion, const Visit& visit,
                 const Stopped& stopped) {
  struct Pending {
    NodeId node;
    Expansion expansion;
  };
  std::vector<Pending> stack;
  for (const NodeId& top : wanted) {
    stack.push_back({top, expansion});
    while (!stack.empty()) {
      const Pending at = stack.back();
      stack.pop_back();
      const std::optional<ChildFacts> facts = visit(at.node, at.expansion);
      if (stopped()) return;
      if (!facts || at.expansion.none() || at.node.depth >= kMaxDepth) continue;
      const Expansion below = oneGenerationBelow(at.expansion);
      for (const bool right : {true, false})
        if (!facts->isLeaf(right) && reaches(at.expansion, facts->level(right)))
          stack.push_back({at.node.child(right), below});
    }
  }
}

}  // namespace meshfront
