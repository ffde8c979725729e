// The box around a mesh in world coordinates, and the sphere around that box.
#pragma once

#include <array>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace meshfront {

struct Bounds {
  glm::dvec3 min{-1.0};
  glm::dvec3 max{1.0};

  [[nodiscard]] static Bounds of(const std::array<double, 3>& low,
                                 const std::array<double, 3>& high) {
    return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
  }
  [[nodiscard]] glm::dvec3 center() const { return min + 0.5 * (max - min); }
  [[nodiscard]] glm::dvec3 extent() const { return max - min; }
  // Half the diagonal; 1 for a single point, so that a camera can always be placed.
  [[nodiscard]] double radius() const {
    const double half = 0.5 * glm::length(extent());
    return half > 0 ? half : 1;
  }
};

}  // namespace meshfront
