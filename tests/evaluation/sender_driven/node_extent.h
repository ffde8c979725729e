// What bounds a part of the surface: a sphere around it and a cone of its normals, and how both are
// joined on the way up a hierarchy.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>

#include "shared/mesh/quantization.h"
#include "tests/evaluation/sender_driven/sender_model.h"

namespace meshfront::evaluation {

struct NodeExtent {
  glm::dvec3 centre{0};
  double radius = -1;  // below 0: nothing yet
  glm::dvec3 axis{0, 0, 1};
  double angle = -1;  // half of the cone's, radians; below 0: no normals yet; pi: any direction

  void includePoint(const glm::dvec3& point);  // keeps the centre of the first one
  void includeNormal(const glm::dvec3& unitNormal);
  void join(const NodeExtent& other);
  // As a test reads it; rounded outwards.
  void writeTo(ViewCriteria& criteria) const;
};

// From a point to the nearest one of a triangle.
[[nodiscard]] double distanceToTriangle(const glm::dvec3& point,
                                        const std::array<glm::dvec3, 3>& triangle);

[[nodiscard]] inline glm::dvec3 gridPoint(const GridPosition& position) {
  return {position[0], position[1], position[2]};
}

}  // namespace meshfront::evaluation
