#include "tests/evaluation/view_independent/geometric_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace meshfront::evaluation {
namespace {

glm::dvec3 pointAt(const GridPosition& position) {
  return {position[0], position[1], position[2]};
}

// Sums over the triangles below a node.
struct SurfaceSums {
  std::array<double, 10> quadric{};  // xx xy xz yy yz zz, x y z, 1
  glm::dvec3 areaNormal{0};
  double area = 0;

  void addTriangle(const glm::dvec3& corner, const glm::dvec3& areaNormalOfIt, double share) {
    const double length = glm::length(areaNormalOfIt);
    if (length == 0) return;
    const double weight = share * length;
    const glm::dvec3 n = areaNormalOfIt / length;
    const double d = -glm::dot(n, corner);
    const std::array<double, 10> plane = {n.x * n.x, n.x * n.y, n.x * n.z, n.y * n.y, n.y * n.z,
                                          n.z * n.z, n.x * d,   n.y * d,   n.z * d,   d * d};
    for (size_t i = 0; i < plane.size(); ++i) quadric.at(i) += weight * plane.at(i);
    areaNormal += share * areaNormalOfIt;
    area += weight;
  }
  void add(const SurfaceSums& other) {
    for (size_t i = 0; i < quadric.size(); ++i) quadric.at(i) += other.quadric.at(i);
    areaNormal += other.areaNormal;
    area += other.area;
  }
  [[nodiscard]] double squaredDistances(const glm::dvec3& p) const {
    const auto& q = quadric;
    const double value = q[0] * p.x * p.x + q[3] * p.y * p.y + q[5] * p.z * p.z + q[9] +
                         2 * (q[1] * p.x * p.y + q[2] * p.x * p.z + q[4] * p.y * p.z + q[6] * p.x +
                              q[7] * p.y + q[8] * p.z);
    return std::max(value, 0.0);
  }
  [[nodiscard]] double normalVariance() const {
    if (area == 0) return 0;
    return std::max(area - glm::dot(areaNormal, areaNormal) / area, 0.0);
  }
};

double errorOf(const SurfaceSums& sums, const glm::dvec3& place, ErrorMeasure measure) {
  switch (measure) {
    case ErrorMeasure::distance:
      return sums.squaredDistances(place);
    case ErrorMeasure::normal:
      return sums.normalVariance();
    case ErrorMeasure::both:
      break;
  }
  return std::sqrt(sums.squaredDistances(place) * sums.normalVariance());
}

std::vector<SurfaceSums> leafSums(const SelectivelyRefinedMesh& mesh) {
  std::vector<SurfaceSums> sums(mesh.vertexSlotCount());
  const auto positions = mesh.positions();
  for (const Triangle& corners : mesh.drawnCorners()) {
    if (corners[0] == corners[1]) continue;
    const glm::dvec3 a = pointAt(positions[corners[0]]);
    const glm::dvec3 areaNormal =
        0.5 * glm::cross(pointAt(positions[corners[1]]) - a, pointAt(positions[corners[2]]) - a);
    for (const uint32_t corner : corners) sums[corner].addTriangle(a, areaNormal, 1.0 / 3);
  }
  return sums;
}

}  // namespace

std::vector<double> geometricErrors(const RefinedPack& full, ErrorMeasure measure) {
  const SelectivelyRefinedMesh& mesh = full.mesh();
  const std::span<const PackRecord> records = full.pack().records();
  const std::vector<SurfaceSums> leaves = leafSums(mesh);
  std::vector<SurfaceSums> sums(records.size());
  std::vector<double> errors(records.size());
  for (size_t i = records.size(); i-- > 0;) {
    const NodeIndex node = full.nodeOf(static_cast<RecordIndex>(i));
    const NodeIndex left = mesh.leftChild(node);
    for (size_t side = 0; side < 2; ++side) {
      const RecordIndex child = records[i].children.at(side);
      if (child != kNoRecord)
        sums[i].add(sums[child]);
      else
        sums[i].add(leaves[mesh.slot(left + static_cast<NodeIndex>(side))]);
    }
    errors[i] = errorOf(sums[i], pointAt(mesh.position(node)), measure);
  }
  return errors;
}

}  // namespace meshfront::evaluation
