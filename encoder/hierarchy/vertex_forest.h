// The vertex hierarchy as the encoder sees it: the forest that a log of half-edge collapses leaves.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "encoder/simplification/simplify.h"
#include "shared/hierarchy/node_id.h"
#include "shared/mesh/quantization.h"

namespace meshfront {

using ForestNode = uint32_t;  // 0 .. leafCount-1: the closed mesh's vertices; then one a collapse
inline constexpr uint32_t kNoNode = UINT32_MAX;

// Memory: 68 bytes a vertex.
class VertexForest {
 public:
  // `positions`: real vertices; virtual ones follow them and are no part of any collapse.
  // Trees: real roots along a Hilbert curve, then the virtual vertices in order.
  VertexForest(std::span<const GridPosition> positions, uint32_t virtualCount,
               std::span<const Collapse> collapses);

  [[nodiscard]] uint32_t leafCount() const { return leafCount_; }
  [[nodiscard]] uint32_t splitCount() const { return static_cast<uint32_t>(left_.size()); }
  [[nodiscard]] uint32_t realRootCount() const { return realRoots_; }
  [[nodiscard]] const std::vector<ForestNode>& roots() const { return roots_; }  // by tree-id
  [[nodiscard]] bool isLeaf(ForestNode node) const { return node < leafCount_; }
  [[nodiscard]] ForestNode left(ForestNode node) const { return left_[node - leafCount_]; }
  [[nodiscard]] ForestNode right(ForestNode node) const { return right_[node - leafCount_]; }
  [[nodiscard]] ForestNode parent(ForestNode node) const { return parent_[node]; }  // or kNoNode
  [[nodiscard]] const NodeId& id(ForestNode node) const { return ids_[node]; }
  // The input vertex whose position the node has: its leftmost leaf.
  [[nodiscard]] uint32_t vertex(ForestNode node) const {
    return isLeaf(node) ? node : vertex_[node - leafCount_];
  }
  // Significance level: the octave in which the mesh's vertex count was when the node collapsed,
  // coarse first. Never smaller than the parent's. Not for leaves.
  [[nodiscard]] unsigned level(ForestNode node) const;
  [[nodiscard]] unsigned maxLevel() const;
  [[nodiscard]] unsigned maxDepth() const { return maxDepth_; }
  // All nodes that are no leaves, by tree, in preorder.
  [[nodiscard]] const std::vector<ForestNode>& splitsInPreorder() const { return preorder_; }
  // The leaf's place among all leaves in preorder; the leaves under a node are a contiguous range.
  [[nodiscard]] uint32_t leafRank(uint32_t vertex) const { return leafRank_[vertex]; }
  struct Range {
    uint32_t begin, end;
    [[nodiscard]] bool holds(uint32_t rank) const { return rank >= begin && rank < end; }
  };
  [[nodiscard]] Range leafRange(ForestNode node) const {
    return isLeaf(node) ? Range{leafRank_[node], leafRank_[node] + 1} : ranges_[node - leafCount_];
  }

 private:
  [[nodiscard]] unsigned levelOfRank(uint64_t rank) const;
  void number(ForestNode root);

  uint32_t leafCount_ = 0;
  uint32_t realRoots_ = 0;
  unsigned maxDepth_ = 0;
  std::vector<ForestNode> left_, right_;  // by node - leafCount
  std::vector<uint32_t> vertex_;          // likewise
  std::vector<Range> ranges_;             // likewise
  std::vector<ForestNode> parent_;        // by node
  std::vector<NodeId> ids_;               // by node
  std::vector<uint32_t> leafRank_;        // by vertex
  std::vector<ForestNode> roots_;
  std::vector<ForestNode> preorder_;
  uint32_t nextRank_ = 0;
};

}  // namespace meshfront
