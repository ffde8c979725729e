#include "encoder/hierarchy/vertex_forest.h"

#include <algorithm>
#include <bit>

#include "encoder/hierarchy/hilbert_curve.h"

namespace meshfront {

VertexForest::VertexForest(std::span<const GridPosition> positions, uint32_t virtualCount,
                           std::span<const Collapse> collapses) {
  const auto real = static_cast<uint32_t>(positions.size());
  leafCount_ = real + virtualCount;
  const auto splits = static_cast<uint32_t>(collapses.size());
  parent_.assign(size_t{leafCount_} + splits, kNoNode);
  left_.reserve(splits);
  right_.reserve(splits);
  vertex_.reserve(splits);
  std::vector<ForestNode> current(real);  // the node that a vertex stands for so far
  for (uint32_t v = 0; v < real; ++v) current[v] = v;
  for (const Collapse& collapse : collapses) {
    const ForestNode node = leafCount_ + static_cast<uint32_t>(left_.size());
    left_.push_back(current[collapse.kept]);
    right_.push_back(current[collapse.removed]);
    vertex_.push_back(collapse.kept);
    parent_[left_.back()] = parent_[right_.back()] = node;
    current[collapse.kept] = node;
    current[collapse.removed] = kNoNode;
  }
  std::vector<std::pair<uint64_t, ForestNode>> order;
  for (uint32_t v = 0; v < real; ++v)
    if (current[v] != kNoNode) order.emplace_back(hilbertIndex(positions[v]), current[v]);
  std::sort(order.begin(), order.end());
  for (const auto& [index, node] : order) roots_.push_back(node);
  realRoots_ = static_cast<uint32_t>(roots_.size());
  for (uint32_t v = real; v < leafCount_; ++v) roots_.push_back(v);

  ids_.resize(size_t{leafCount_} + splits);
  leafRank_.resize(leafCount_);
  ranges_.resize(splits);
  preorder_.reserve(splits);
  for (uint32_t tree = 0; tree < roots_.size(); ++tree) {
    ids_[roots_[tree]] = NodeId::root(tree);
    number(roots_[tree]);
  }
}

void VertexForest::number(ForestNode root) {
  // Each node is met on the way down, and once more behind its leaves to close its range.
  struct Visit {
    ForestNode node;
    bool closing;
  };
  std::vector<Visit> stack{{root, false}};
  while (!stack.empty()) {
    const auto [node, closing] = stack.back();
    stack.pop_back();
    maxDepth_ = std::max<unsigned>(maxDepth_, ids_[node].depth);
    if (isLeaf(node)) {
      leafRank_[node] = nextRank_++;
    } else if (closing) {
      ranges_[node - leafCount_].end = nextRank_;
    } else {
      ranges_[node - leafCount_].begin = nextRank_;
      preorder_.push_back(node);
      ids_[left(node)] = ids_[node].child(false);
      ids_[right(node)] = ids_[node].child(true);
      stack.push_back({node, true});
      stack.push_back({right(node), false});
      stack.push_back({left(node), false});
    }
  }
}

unsigned VertexForest::levelOfRank(uint64_t rank) const {
  return static_cast<unsigned>(std::bit_width((realRoots_ + rank) / realRoots_)) - 1;
}

unsigned VertexForest::level(ForestNode node) const {
  return levelOfRank(splitCount() - 1 - (node - leafCount_));
}

unsigned VertexForest::maxLevel() const {
  return splitCount() == 0 ? 0 : levelOfRank(splitCount() - 1);
}

}  // namespace meshfront
