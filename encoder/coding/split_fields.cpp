#include "encoder/coding/split_fields.h"

#include "shared/codec/position_prediction.h"

namespace meshfront {

SplitFields::SplitFields(const CodingInput& input, const VertexForest& forest, const BaseMesh& base)
    : input_(input), forest_(forest), normals_(forest.splitCount()) {
  std::vector<GridPosition> rootPositions;
  for (const auto& root : base.roots) rootPositions.push_back(root.position);
  const auto rootNormals = baseNormals(rootPositions, base.triangles);
  const auto set = [&](ForestNode node, const PredictedNormal& normal) {
    if (!forest_.isLeaf(node)) normals_[node - forest_.leafCount()] = normal;
  };
  for (uint32_t tree = 0; tree < forest.realRootCount(); ++tree)
    set(forest.roots()[tree], rootNormals[tree]);
  for (const ForestNode node : forest.splitsInPreorder()) {
    const PredictedNormal below = normalAfter(normal(node), delta(node));
    set(forest.left(node), below);
    set(forest.right(node), below);
  }
}

GridPosition SplitFields::position(ForestNode node) const {
  return input_.positions[forest_.vertex(node)];
}

GridPosition SplitFields::delta(ForestNode node) const {
  const GridPosition s = position(node);
  const GridPosition t = position(forest_.right(node));
  return {t[0] - s[0], t[1] - s[1], t[2] - s[2]};
}

unsigned SplitFields::level(uint32_t split) const {
  return forest_.level(forest_.splitsInPreorder()[split]);
}

unsigned SplitFields::leafFlags(uint32_t split) const {
  const ForestNode node = forest_.splitsInPreorder()[split];
  return (forest_.isLeaf(forest_.left(node)) ? 2U : 0U) |
         (forest_.isLeaf(forest_.right(node)) ? 1U : 0U);
}

Record SplitFields::record(uint32_t split) const {
  const ForestNode node = forest_.splitsInPreorder()[split];
  const ForestNode u = forest_.left(node);
  const ForestNode t = forest_.right(node);
  Record record;
  record.leftIsLeaf = forest_.isLeaf(u);
  record.rightIsLeaf = forest_.isLeaf(t);
  if (!record.leftIsLeaf) record.leftLevel = static_cast<uint8_t>(forest_.level(u));
  if (!record.rightIsLeaf) record.rightLevel = static_cast<uint8_t>(forest_.level(t));
  const GridPosition d = delta(node);
  const PredictedNormal& n = normal(node);
  const unsigned a = mainAxis(n);
  record.deltaB = d[(a + 1) % 3];
  record.deltaC = d[(a + 2) % 3];
  record.residualA = d[a] - predictedAlong(n, a, record.deltaB, record.deltaC);
  if (!input_.attributes.empty())
    record.attributes = attributeDelta(input_.attributes[forest_.vertex(node)],
                                       input_.attributes[forest_.vertex(t)]);
  return record;
}

}  // namespace meshfront
