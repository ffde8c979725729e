// All records of a pack as a plain forest, for experiments that look at the whole hierarchy at
// once: who is whose parent, where the bits lie.
//
//   auto pack = PackRecords::read("bunny.pack");
//   auto refined = RefinedPack::fromBase(*pack);
//   refined->split(0);                      // the first record's node, active at first if a root's
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "shared/codec/base_mesh.h"
#include "shared/codec/chunk.h"
#include "shared/refinement/selectively_refined_mesh.h"
#include "shared/result.h"
#include "shared/store/pack.h"

namespace meshfront::evaluation {

using RecordIndex = uint32_t;  // into PackRecords::records()
inline constexpr RecordIndex kNoRecord = UINT32_MAX;

struct PackRecord {
  RecordEntry entry;  // the offset is into the chunk's bytes
  uint32_t chunk = 0;
  RecordIndex parent = kNoRecord;
  std::array<RecordIndex, 2> children{kNoRecord, kNoRecord};  // left, right; none for a leaf
};

// Needs the pack's file as long as it lives. Movable.
class PackRecords {
 public:
  // An error where the pack cannot be read, is damaged, or a node's parent has no record.
  [[nodiscard]] static Result<PackRecords> read(const std::filesystem::path& path);

  [[nodiscard]] const std::shared_ptr<const Pack>& pack() const { return pack_; }
  [[nodiscard]] const MeshMetadata& metadata() const { return pack_->metadata(); }
  [[nodiscard]] const BaseMesh& base() const { return base_; }
  // In preorder: a parent in front of its children.
  [[nodiscard]] std::span<const PackRecord> records() const { return records_; }
  [[nodiscard]] std::span<const uint8_t> chunk(uint32_t number) const { return chunks_[number]; }
  // kNoRecord for a leaf and for what is no node.
  [[nodiscard]] RecordIndex find(const NodeId& id) const;
  // In an order in which every record can be applied: coarse levels first, parents before children.
  [[nodiscard]] std::vector<RecordIndex> byLevel() const;

 private:
  PackRecords() = default;
  std::shared_ptr<const Pack> pack_;
  BaseMesh base_;
  std::vector<std::span<const uint8_t>> chunks_;
  std::vector<PackRecord> records_;
};

// A mesh that is refined by a pack's records, by number. The pack must outlive it.
class RefinedPack {
 public:
  [[nodiscard]] static Result<RefinedPack> fromBase(const PackRecords& pack);

  [[nodiscard]] const PackRecords& pack() const { return *pack_; }
  [[nodiscard]] SelectivelyRefinedMesh& mesh() { return mesh_; }
  [[nodiscard]] const SelectivelyRefinedMesh& mesh() const { return mesh_; }
  // kNoRecord for leaves and virtual vertices.
  [[nodiscard]] RecordIndex recordOf(NodeIndex node) const { return recordOf_[node]; }
  // kNone while the node has not been met: its parent has never been split.
  [[nodiscard]] NodeIndex nodeOf(RecordIndex record) const { return nodeOf_[record]; }

  // The record's node must be active.
  Result<void> split(RecordIndex record);
  Result<void> splitAll(std::span<const RecordIndex> records);

 private:
  RefinedPack(const PackRecords& pack, SelectivelyRefinedMesh mesh);
  void setRecord(NodeIndex node, RecordIndex record);

  const PackRecords* pack_;
  SelectivelyRefinedMesh mesh_;
  std::vector<RecordIndex> recordOf_;
  std::vector<NodeIndex> nodeOf_;
};

}  // namespace meshfront::evaluation
