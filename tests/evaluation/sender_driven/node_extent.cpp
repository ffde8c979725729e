#include "tests/evaluation/sender_driven/node_extent.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace meshfront::evaluation {
namespace {

constexpr double kHalfTurn = std::numbers::pi;
constexpr double kRightAngle = kHalfTurn / 2;

double angleBetween(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// The narrowest cone around both, its axis between theirs.
void joinCones(glm::dvec3& axis, double& angle, const glm::dvec3& otherAxis, double otherAngle) {
  if (otherAngle < 0) return;
  if (angle < 0) {
    axis = otherAxis;
    angle = otherAngle;
    return;
  }
  const double between = angleBetween(axis, otherAxis);
  if (between + otherAngle <= angle) return;
  if (between + angle <= otherAngle) {
    axis = otherAxis;
    angle = otherAngle;
    return;
  }
  const double joined = (between + angle + otherAngle) / 2;
  if (joined >= kRightAngle) {
    angle = kHalfTurn;
    return;
  }
  // Turned from the one axis towards the other; between > 0, since neither cone holds the other.
  const double turn = joined - angle;
  const double sine = std::sin(between);
  axis = glm::normalize(std::sin(between - turn) / sine * axis + std::sin(turn) / sine * otherAxis);
  angle = joined;
}

}  // namespace

void NodeExtent::includePoint(const glm::dvec3& point) {
  if (radius < 0) {
    centre = point;
    radius = 0;
    return;
  }
  radius = std::max(radius, glm::length(point - centre));
}

void NodeExtent::includeNormal(const glm::dvec3& unitNormal) {
  joinCones(axis, angle, unitNormal, 0);
}

void NodeExtent::join(const NodeExtent& other) {
  if (other.radius >= 0) {
    const double between = glm::length(other.centre - centre);
    if (radius < 0 || between + radius <= other.radius) {
      centre = other.centre;
      radius = other.radius;
    } else if (between + other.radius > radius) {
      const double joined = (between + radius + other.radius) / 2;
      centre += (joined - radius) / between * (other.centre - centre);
      radius = joined;
    }
  }
  joinCones(axis, angle, other.axis, other.angle);
}

void NodeExtent::writeTo(ViewCriteria& criteria) const {
  criteria.centre = {static_cast<float>(centre.x), static_cast<float>(centre.y),
                     static_cast<float>(centre.z)};
  // Half a step and a little for the roundings.
  criteria.radius = static_cast<float>(std::max(radius, 0.0) * 1.00001 + 0.5);
  criteria.sine = ViewCriteria::kNoCone;
  if (angle < 0 || angle > 0.99 * kRightAngle) return;
  for (int i = 0; i < 3; ++i)
    criteria.axis[static_cast<size_t>(i)] = static_cast<int16_t>(std::lround(axis[i] * 32767));
  criteria.sine = static_cast<int16_t>(std::ceil(std::min(std::sin(angle) + 1e-4, 1.0) * 32767));
}

double distanceToTriangle(const glm::dvec3& point, const std::array<glm::dvec3, 3>& triangle) {
  const glm::dvec3 normal = glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
  const double square = glm::dot(normal, normal);
  bool above = square > 0;  // its plane's nearest point lies in the triangle
  double nearest = -1;
  for (size_t i = 0; i < 3; ++i) {
    const glm::dvec3& from = triangle[i];
    const glm::dvec3 edge = triangle[(i + 1) % 3] - from;
    const double length = glm::dot(edge, edge);
    const double along =
        length > 0 ? std::clamp(glm::dot(point - from, edge) / length, 0.0, 1.0) : 0;
    const double distance = glm::length(point - from - along * edge);
    if (nearest < 0 || distance < nearest) nearest = distance;
    above = above && glm::dot(glm::cross(normal, edge), point - from) >= 0;
  }
  return above ? std::abs(glm::dot(point - triangle[0], normal)) / std::sqrt(square) : nearest;
}

}  // namespace meshfront::evaluation
