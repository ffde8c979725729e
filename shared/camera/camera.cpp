#include "shared/camera/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

namespace meshfront {
namespace {

// The nearest plane as a share of the farthest: float depth, reversed, carries it easily.
constexpr double kNearestShare = 1e-5;
// Of the picture's height or width, taken by a mesh's box that was made to fit.
constexpr double kFilledShare = 0.96;
// How near to straight up or down an orbit may come, radians.
constexpr double kPoleMargin = 0.01;

glm::dvec3 anyPerpendicular(const glm::dvec3& unit) {
  const glm::dvec3 other = std::abs(unit.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  return glm::normalize(glm::cross(unit, other));
}

// Rodrigues' rotation of v about a unit axis.
glm::dvec3 rotated(const glm::dvec3& v, const glm::dvec3& axis, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return v * c + glm::cross(axis, v) * s + axis * (glm::dot(axis, v) * (1 - c));
}

}  // namespace

double pixelsAtOne(const Camera& camera, PixelSize picture) {
  return picture.height / (2 * std::tan(camera.verticalFov / 2));
}

ViewAxes viewAxes(const Camera& camera) {
  ViewAxes axes{};
  const glm::dvec3 toTarget = camera.target - camera.eye;
  const double distance = glm::length(toTarget);
  axes.forward = distance > 0 ? toTarget / distance : glm::dvec3(0, 0, -1);
  const glm::dvec3 side = glm::cross(axes.forward, camera.up);
  const double length = glm::length(side);
  axes.right =
      length > 1e-9 * glm::length(camera.up) ? side / length : anyPerpendicular(axes.forward);
  axes.upward = glm::cross(axes.right, axes.forward);
  return axes;
}

Projection Projection::fit(const Camera& camera, const Bounds& bounds, double aspect) {
  Projection projection;
  projection.camera = camera;
  projection.aspect = aspect;
  const double radius = bounds.radius() * 1.001;
  const double along = glm::dot(bounds.center() - camera.eye, viewAxes(camera).forward);
  projection.farPlane = along + radius > 0 ? along + radius : radius;
  projection.nearPlane = std::max(along - radius, projection.farPlane * kNearestShare);
  return projection;
}

glm::dmat4 Projection::viewFrom(const glm::dvec3& origin) const {
  const ViewAxes axes = viewAxes(camera);
  const glm::dvec3 shift = origin - camera.eye;  // small when the origin is near the eye
  glm::dmat4 m(1.0);                             // m[column][row]
  for (int i = 0; i < 3; ++i) {
    m[i][0] = axes.right[i];
    m[i][1] = axes.upward[i];
    m[i][2] = -axes.forward[i];
  }
  m[3] = glm::dvec4(glm::dot(axes.right, shift), glm::dot(axes.upward, shift),
                    -glm::dot(axes.forward, shift), 1);
  return m;
}

glm::dmat4 Projection::clipFrom(const glm::dvec3& origin) const {
  const double scale = 1 / std::tan(0.5 * camera.verticalFov);
  const double span = farPlane - nearPlane;
  glm::dmat4 p(0.0);
  p[0][0] = scale / aspect;
  p[1][1] = scale;
  p[2][2] = nearPlane / span;
  p[2][3] = -1;
  p[3][2] = nearPlane * farPlane / span;
  return p * viewFrom(origin);
}

glm::dvec3 Projection::atDistance(glm::dvec2 place, double alongView) const {
  const ViewAxes axes = viewAxes(camera);
  const double half = std::tan(0.5 * camera.verticalFov) * alongView;
  return camera.eye + axes.forward * alongView + axes.right * (place.x * half * aspect) +
         axes.upward * (place.y * half);
}

glm::dvec3 Projection::worldPoint(glm::dvec2 place, double depth) const {
  return atDistance(place, nearPlane * farPlane / (depth * (farPlane - nearPlane) + nearPlane));
}

glm::dvec3 Projection::targetPlanePoint(glm::dvec2 place) const {
  return atDistance(place, glm::length(camera.target - camera.eye));
}

void orbit(Camera& camera, double turn, double lift) {
  const glm::dvec3 up = glm::normalize(camera.up);
  glm::dvec3 fromTarget = rotated(camera.eye - camera.target, up, turn);
  const double distance = glm::length(fromTarget);
  if (!(distance > 0)) {
    return;
  }
  const double elevation = std::asin(std::clamp(glm::dot(fromTarget, up) / distance, -1.0, 1.0));
  const double limit = 0.5 * glm::radians(180.0) - kPoleMargin;
  const double wanted = std::clamp(elevation + lift, -limit, limit);
  glm::dvec3 level = fromTarget - up * glm::dot(fromTarget, up);
  level = glm::length(level) > 1e-9 * distance ? glm::normalize(level) : anyPerpendicular(up);
  fromTarget = distance * (level * std::cos(wanted) + up * std::sin(wanted));
  camera.eye = camera.target + fromTarget;
}

void pan(Camera& camera, glm::dvec2 pixels, int pictureHeight, std::optional<double> distance) {
  const ViewAxes axes = viewAxes(camera);
  const double along = distance.value_or(glm::length(camera.target - camera.eye));
  const double height = 2 * std::tan(0.5 * camera.verticalFov) * along;
  const double perPixel = height / std::max(1, pictureHeight);
  const glm::dvec3 move = (axes.right * pixels.x + axes.upward * pixels.y) * -perPixel;
  camera.eye += move;
  camera.target += move;
}

void roll(Camera& camera, double angle) {
  const ViewAxes axes = viewAxes(camera);
  // The picture turns one way when the camera turns the other.
  camera.up = rotated(glm::normalize(camera.up), axes.forward, -angle);
}

void zoomTo(Camera& camera, const glm::dvec3& point, double factor) {
  camera.eye = point + (camera.eye - point) * factor;
  camera.target = point + (camera.target - point) * factor;
}

void fitTo(Camera& camera, const Bounds& bounds, double aspect) {
  const glm::dvec3 forward = viewAxes(camera).forward;
  camera.target = bounds.center();
  camera.eye = camera.target - forward * fittingDistance(camera, bounds, aspect);
}

double fittingDistance(const Camera& camera, const Bounds& bounds, double aspect) {
  const ViewAxes axes = viewAxes(camera);
  const double tangent = std::tan(0.5 * camera.verticalFov) * kFilledShare;
  double distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 place((corner & 1) != 0 ? bounds.max.x : bounds.min.x,
                           (corner & 2) != 0 ? bounds.max.y : bounds.min.y,
                           (corner & 4) != 0 ? bounds.max.z : bounds.min.z);
    const glm::dvec3 offset = place - camera.target;
    const double aside = std::abs(glm::dot(offset, axes.right)) / aspect;
    const double above = std::abs(glm::dot(offset, axes.upward));
    distance =
        std::max(distance, std::max(aside, above) / tangent - glm::dot(offset, axes.forward));
  }
  // A single point, or a view along a flat box's edge: any distance shows it.
  return std::max(distance, 0.1 * bounds.radius());
}

}  // namespace meshfront
