// What the records say beside the cut: leaf flags, levels, positions, attributes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "encoder/coding/mesh_coder.h"
#include "shared/codec/record.h"

namespace meshfront {

class SplitFields {
 public:
  // Keeps references to both. Predicted normals take 6 bytes a split.
  SplitFields(const CodingInput& input, const VertexForest& forest, const BaseMesh& base);

  [[nodiscard]] uint32_t size() const { return forest_.splitCount(); }
  // By number in preorder. All but cutBegin and cutEnd are set.
  [[nodiscard]] Record record(uint32_t split) const;
  [[nodiscard]] unsigned level(uint32_t split) const;
  [[nodiscard]] unsigned leafFlags(uint32_t split) const;
  [[nodiscard]] GridPosition position(ForestNode node) const;  // of a real one
  // d and the predicted normal of a node that is no leaf.
  [[nodiscard]] GridPosition delta(ForestNode node) const;
  [[nodiscard]] const PredictedNormal& normal(ForestNode node) const {
    return normals_[node - forest_.leafCount()];
  }

 private:
  const CodingInput& input_;
  const VertexForest& forest_;
  std::vector<PredictedNormal> normals_;  // by split node - leafCount
};

}  // namespace meshfront
