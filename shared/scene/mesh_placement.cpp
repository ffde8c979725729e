#include "shared/scene/mesh_placement.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace meshfront {

Bounds movedBounds(const Bounds& bounds, const glm::dmat4& worldFromMesh) {
  // Arvo, Transforming axis-aligned bounding boxes (Graphics Gems, 1990).
  const glm::dvec3 origin(worldFromMesh[3]);
  Bounds moved{origin, origin};
  for (int column = 0; column < 3; ++column) {
    const glm::dvec3 axis(worldFromMesh[column]);
    const glm::dvec3 a = axis * bounds.min[column];
    const glm::dvec3 b = axis * bounds.max[column];
    moved.min += glm::min(a, b);
    moved.max += glm::max(a, b);
  }
  return moved;
}

Bounds unitedBounds(const Bounds& a, const Bounds& b) {
  return {glm::min(a.min, b.min), glm::max(a.max, b.max)};
}

double apparentSize(const Bounds& world, const glm::dvec3& eye) {
  const glm::dvec3 nearest = glm::clamp(eye, world.min, world.max);
  const double distance = glm::distance(eye, nearest);
  const double radius = world.radius();
  return distance * kLargestApparentSize <= radius ? kLargestApparentSize : radius / distance;
}

unsigned levelsBehind(double apparentSize, double largestApparentSize) {
  if (!(apparentSize > 0) || !(largestApparentSize > apparentSize)) return 0;
  const double octaves = 2 * std::log2(largestApparentSize / apparentSize);
  return static_cast<unsigned>(std::lround(std::min<double>(octaves, kMostLevelsBehind)));
}

}  // namespace meshfront
