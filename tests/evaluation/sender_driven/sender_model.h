// A pack's mesh as the sender-driven server holds it, shared by all sessions: its hierarchy and
// records in flat arrays, and for each node the criteria that a view is tested by. They are not in
// the pack: the full mesh is decoded once when it is loaded.
//
// Nodes are numbered in preorder, those with a record only (leaves are never sent): the left child,
// if it has a record, is the next number, and what is below a node are the numbers up to end().
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/codec/base_mesh.h"
#include "shared/hierarchy/node_id.h"
#include "shared/mesh/quantization.h"
#include "shared/result.h"
#include "shared/store/pack.h"

namespace meshfront::evaluation {

inline constexpr uint32_t kNoNode = UINT32_MAX;

// What a test reads of a node, in half a cache line. Grid steps.
struct alignas(32) ViewCriteria {
  // Sphere around all leaves below and their neighbours in the full mesh.
  std::array<float, 3> centre{};
  float radius = 0;
  // How far the surface moves by the split of the node, or of any below it: never less than a
  // child's.
  float error = 0;
  // Cone of the full mesh's normals at the leaves below, in 32767ths.
  std::array<int16_t, 3> axis{};
  int16_t sine = kNoCone;  // of the cone's half-angle
  uint32_t end = 0;        // the first number behind the nodes below

  static constexpr int16_t kNoCone = -1;  // a right angle or more: always towards some eye
};
static_assert(sizeof(ViewCriteria) == 32);

class SenderModel {
 public:
  [[nodiscard]] static Result<SenderModel> load(const Pack& pack);
  // The same of a pack's parts in memory.
  [[nodiscard]] static Result<SenderModel> load(const Quantization& quantization,
                                                std::span<const uint8_t> base,
                                                std::span<const std::span<const uint8_t>> chunks);

  [[nodiscard]] uint32_t nodeCount() const { return static_cast<uint32_t>(criteria_.size()); }
  [[nodiscard]] const ViewCriteria& criteria(uint32_t node) const { return criteria_[node]; }
  [[nodiscard]] uint32_t end(uint32_t node) const { return criteria_[node].end; }
  [[nodiscard]] const NodeId& id(uint32_t node) const { return ids_[node]; }
  [[nodiscard]] unsigned level(uint32_t node) const { return facts_[node].level; }
  // Of nodes that have a record; kNoNode else.
  [[nodiscard]] uint32_t leftChild(uint32_t node) const {
    return (facts_[node].leaves & 2) != 0 ? kNoNode : node + 1;
  }
  [[nodiscard]] uint32_t rightChild(uint32_t node) const {
    if ((facts_[node].leaves & 1) != 0) return kNoNode;
    return (facts_[node].leaves & 2) != 0 ? node + 1 : end(node + 1);
  }
  [[nodiscard]] std::span<const uint32_t> roots() const { return roots_; }            // ascending
  [[nodiscard]] uint32_t parent(uint32_t node) const { return facts_[node].parent; }  // or kNoNode
  // kNoNode for a leaf or what is not in the mesh.
  [[nodiscard]] uint32_t find(const NodeId& id) const;

  // Number of a node in the order of the pack's chunks: level by level, each in preorder.
  [[nodiscard]] uint32_t tag(uint32_t node) const { return facts_[node].tag; }
  // The first tag of each level, and behind the last.
  [[nodiscard]] std::span<const uint32_t> levelTags() const { return levelTags_; }

  // The record's bits lie in recordBytes() from there on.
  [[nodiscard]] uint64_t recordBegin(uint32_t node) const { return recordBegins_[node]; }
  [[nodiscard]] uint32_t recordBits(uint32_t node) const {
    return static_cast<uint32_t>(recordBegins_[node + 1] - recordBegins_[node]);
  }
  [[nodiscard]] std::span<const uint8_t> recordBytes() const { return recordBytes_; }

  [[nodiscard]] const BaseMesh& base() const { return base_; }
  [[nodiscard]] std::span<const uint8_t> baseBytes() const { return baseBytes_; }
  [[nodiscard]] const Quantization& quantization() const { return quantization_; }
  [[nodiscard]] unsigned maxDepth() const { return maxDepth_; }
  // Held for all sessions together.
  [[nodiscard]] size_t memoryBytes() const;

 private:
  struct Facts {
    uint32_t tag = 0;
    uint32_t parent = kNoNode;
    uint8_t level = 0;
    uint8_t leaves = 0;  // leaf flags: u * 2 + t
  };

  std::vector<ViewCriteria> criteria_;
  std::vector<Facts> facts_;
  std::vector<NodeId> ids_;
  std::vector<uint64_t> recordBegins_;
  std::vector<uint8_t> recordBytes_;
  std::vector<uint32_t> roots_;
  std::vector<uint32_t> levelTags_;
  BaseMesh base_;
  std::vector<uint8_t> baseBytes_;
  Quantization quantization_;
  unsigned maxDepth_ = 0;
};

}  // namespace meshfront::evaluation
