// Decodes a whole pack once, coarse to fine, and tells for each node what its split did: what the
// criteria of a sender-driven server are made of, which a pack does not hold.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/codec/chunk.h"
#include "shared/refinement/selectively_refined_mesh.h"
#include "shared/result.h"
#include "tests/evaluation/sender_driven/node_extent.h"

namespace meshfront::evaluation {

struct DecodedRecord {
  RecordEntry entry;  // its offset is into the chunk
  uint32_t chunk = 0;
  float error = 0;         // distance of the new vertex from the surface before, grid steps
  NodeIndex mesh = kNone;  // the node in the decoded mesh
};

class FullDecoding {
 public:
  [[nodiscard]] static Result<FullDecoding> of(const BaseMesh& base,
                                               std::span<const std::span<const uint8_t>> chunks);
  // In the order of the chunks.
  [[nodiscard]] std::vector<DecodedRecord>& records() { return records_; }
  // What bounds the full mesh at a leaf child, its neighbours included.
  [[nodiscard]] const NodeExtent& leafExtent(const DecodedRecord& parent, bool right) const {
    return extents_[mesh_.slot(mesh_.leftChild(parent.mesh) + (right ? 1 : 0))];
  }

 private:
  explicit FullDecoding(SelectivelyRefinedMesh mesh) : mesh_(std::move(mesh)) {}
  Result<void> splitChunk(uint32_t number, std::span<const uint8_t> bytes);
  [[nodiscard]] double distanceFromRing(VertexSlot slot, const glm::dvec3& point) const;
  [[nodiscard]] bool isInsideOut() const;
  void measureLeaves();

  SelectivelyRefinedMesh mesh_;
  std::vector<DecodedRecord> records_;
  std::vector<NodeExtent> extents_;  // by vertex slot
  std::vector<std::array<glm::dvec3, 3>> ring_;
};

}  // namespace meshfront::evaluation
