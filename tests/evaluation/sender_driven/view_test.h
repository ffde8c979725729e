// The three tests of a node against a view: frustum, cone of normals, error in pixels. Each holds
// for all that is below the node if it holds for the node.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "tests/evaluation/sender_driven/sender_model.h"
#include "tests/evaluation/sender_driven/view_request.h"

namespace meshfront::evaluation {

class ViewTest {
 public:
  ViewTest() = default;
  explicit ViewTest(const ViewRequest& request) : tolerance_(request.tolerance) {
    const auto& m = request.viewFromGrid;
    const float halfTangent = std::tan(request.verticalFov / 2);
    pixelsAtOne_ = static_cast<float>(request.pictureHeight) / (2 * halfTangent);
    for (size_t i = 0; i < 3; ++i) eye_[i] = -(m[i] * m[3] + m[4 + i] * m[7] + m[8 + i] * m[11]);
    // Inward normals of the planes through the eye: left, right, bottom, top.
    for (size_t plane = 0; plane < 4; ++plane) {
      const float tangent = plane < 2 ? halfTangent * request.aspect : halfTangent;
      const float length = std::sqrt(1 + tangent * tangent);
      const float sign = plane % 2 == 0 ? 1.0F : -1.0F;
      const size_t row = plane < 2 ? 0 : 4;
      for (size_t i = 0; i < 3; ++i)
        planes_[plane][i] = (sign * m[row + i] - tangent * m[8 + i]) / length;
    }
  }

  // Whether the view may show the node's split; then its error in pixels.
  [[nodiscard]] bool passes(const ViewCriteria& node, float& pixels) const {
    const float dx = node.centre[0] - eye_[0];
    const float dy = node.centre[1] - eye_[1];
    const float dz = node.centre[2] - eye_[2];
    bool inside = true;
    for (const auto& plane : planes_)
      inside &= plane[0] * dx + plane[1] * dy + plane[2] * dz >= -node.radius;
    if (!inside) return false;
    const float square = dx * dx + dy * dy + dz * dz;
    const float distance = std::sqrt(square);
    const float nearest = distance - node.radius;
    pixels = node.error * pixelsAtOne_ / (nearest > kNearest ? nearest : kNearest);
    if (!(pixels >= tolerance_)) return false;
    if (node.sine < 0 || nearest <= 0) return true;
    // All normals look away if the cone, widened by the sphere's angle, stays below a right angle
    // from the line of sight.
    const float sine = static_cast<float>(node.sine) * kUnit;
    const float cosine = std::sqrt(1 - sine * sine);
    const float tangentLength = std::sqrt(square - node.radius * node.radius);
    if (cosine * tangentLength <= sine * node.radius) return true;
    const float along =
        kUnit * (dx * static_cast<float>(node.axis[0]) + dy * static_cast<float>(node.axis[1]) +
                 dz * static_cast<float>(node.axis[2]));
    return along <= sine * tangentLength + cosine * node.radius;
  }

 private:
  static constexpr float kNearest = 1;  // grid step
  static constexpr float kUnit = 1.0F / 32767;
  std::array<float, 3> eye_{};
  std::array<std::array<float, 3>, 4> planes_{};
  float pixelsAtOne_ = 1;
  float tolerance_ = 0;
};

}  // namespace meshfront::evaluation
