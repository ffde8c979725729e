// Meshes encoded in memory, for tests that need real records.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "encoder/pipeline/encode_mesh.h"
#include "shared/codec/base_mesh.h"
#include "shared/codec/chunk.h"
#include "shared/refinement/selectively_refined_mesh.h"

namespace meshfront {

// A pack's content, decoded: the base, and every record by its node.
class RecordsAtHand {
 public:
  explicit RecordsAtHand(PackContent content) : content_(std::move(content)) {
    base_ = decodeBaseMesh(content_.base).value();
    for (const auto& bytes : content_.chunks) {
      Chunk chunk = decodeChunk(bytes, base_.tables).value();
      for (const RecordEntry& entry : chunk.entries) records_.push_back({entry, &bytes});
    }
    std::sort(records_.begin(), records_.end(),
              [](const Place& a, const Place& b) { return a.entry.id < b.entry.id; });
  }
  RecordsAtHand(const RecordsAtHand&) = delete;
  RecordsAtHand& operator=(const RecordsAtHand&) = delete;

  struct Place {
    RecordEntry entry;
    const std::vector<uint8_t>* bytes;
  };
  [[nodiscard]] const PackContent& content() const { return content_; }
  [[nodiscard]] const BaseMesh& base() const { return base_; }
  [[nodiscard]] const std::vector<Place>& all() const { return records_; }  // preorder
  [[nodiscard]] const Place& of(const NodeId& id) const {
    return *std::lower_bound(records_.begin(), records_.end(), id,
                             [](const Place& a, const NodeId& b) { return a.entry.id < b; });
  }
  Result<void> split(SelectivelyRefinedMesh& mesh, NodeIndex node) const {
    const Place& place = of(mesh.id(node));
    return mesh.split(node, *place.bytes, place.entry.bitOffset, place.entry.bitLength);
  }

 private:
  PackContent content_;
  BaseMesh base_;
  std::vector<Place> records_;
};

[[nodiscard]] inline PackContent encodedContent(IndexedMesh mesh, unsigned bits = 12) {
  EncodeOptions options;
  options.name = "test";
  options.quantizationBits = bits;
  options.baseFraction = 0.02;
  return std::move(encodeMesh(std::move(mesh), options).value().pack);
}

}  // namespace meshfront
