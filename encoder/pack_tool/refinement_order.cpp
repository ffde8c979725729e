#include "encoder/pack_tool/refinement_order.h"

#include <cmath>

namespace meshfront {
namespace {

double squaredDistance(const GridPosition& a, const GridPosition& b) {
  double sum = 0;
  for (size_t i = 0; i < 3; ++i) sum += std::pow(static_cast<double>(a[i]) - b[i], 2);
  return sum;
}

}  // namespace

std::string nameOf(OrderKind kind) {
  switch (kind) {
    case OrderKind::uniformRandom:
      return "uniform random";
    case OrderKind::regionFirst:
      return "region first";
    case OrderKind::depthFirst:
      return "depth first";
    case OrderKind::largestDelta:
      return "largest delta first";
    case OrderKind::breadthFirst:
      return "breadth first";
    case OrderKind::significance:
      return "significance";
    case OrderKind::finestFirst:
      return "finest first";
    case OrderKind::randomSubtree:
      return "random subtrees";
  }
  return "";
}

RefinementOrder::RefinementOrder(OrderKind kind, uint64_t seed, const SelectivelyRefinedMesh& mesh)
    : kind_(kind), mesh_(mesh), random_(seed) {
  const size_t roots = mesh.base().roots.size();
  if (roots > 0) centre_ = mesh.base().roots[random_() % roots].position;
}

double RefinementOrder::keyOf(NodeIndex node) {
  const double newest = -(counter_ += 1);
  switch (kind_) {
    case OrderKind::uniformRandom:
      return static_cast<double>(random_() >> 11);
    case OrderKind::regionFirst:
      return squaredDistance(mesh_.positions()[mesh_.slot(node)], centre_);
    case OrderKind::depthFirst:
      return newest;
    case OrderKind::largestDelta: {
      // Its siblings are both active when a node is added, so their distance is the parent's delta.
      const NodeIndex parent = mesh_.parent(node);
      if (parent == kNone) return -1e30;
      const NodeIndex left = mesh_.leftChild(parent);
      return -squaredDistance(mesh_.positions()[mesh_.slot(left)],
                              mesh_.positions()[mesh_.slot(left + 1)]);
    }
    case OrderKind::breadthFirst:
      return -newest;
    case OrderKind::significance:
      return mesh_.level(node);
    case OrderKind::finestFirst:
      return -static_cast<double>(mesh_.level(node));
    case OrderKind::randomSubtree:
      return newest + static_cast<double>(random_() % 64);
  }
  return 0;
}

void RefinementOrder::add(NodeIndex node) {
  queue_.push({keyOf(node), node});
}

NodeIndex RefinementOrder::takeFirst() {
  const NodeIndex node = queue_.top().node;
  queue_.pop();
  return node;
}

}  // namespace meshfront
