#include "shared/scene/view_prediction.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace meshfront {
namespace {

constexpr double kShortestTime = 0.01;   // seconds between two views that tell a motion
constexpr double kSmallestTurn = 1e-6;   // radians
constexpr double kSmallestMove = 1e-6;   // of the distance to the target
constexpr double kSmallestScale = 1e-6;  // logarithm

// v turned from the direction of `from` towards that of `to`, on by `angle` more. Both are unit.
glm::dvec3 turnedOn(const glm::dvec3& v, const glm::dvec3& axis, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return v * c + glm::cross(axis, v) * s + axis * (glm::dot(axis, v) * (1 - c));
}

}  // namespace

void ViewPrediction::see(double seconds, const Camera& camera) {
  if (!seen_.empty() && seconds <= seen_.back().seconds) {
    seen_.back().camera = camera;
    return;
  }
  seen_.push_back({seconds, camera});
  while (seen_.size() > 2 && seen_.front().seconds < seconds - kMemory) seen_.pop_front();
}

std::optional<Camera> ViewPrediction::ahead(double seconds) const {
  if (seen_.size() < 2 || seconds <= 0) return std::nullopt;
  const Camera& now = seen_.back().camera;
  const Camera& then = seen_.front().camera;
  const double passed = seen_.back().seconds - seen_.front().seconds;
  if (passed < kShortestTime || passed > 2 * kMemory) return std::nullopt;
  const double share = seconds / passed;

  const glm::dvec3 offsetThen = then.eye - then.target;
  const glm::dvec3 offsetNow = now.eye - now.target;
  const double distanceThen = glm::length(offsetThen);
  const double distanceNow = glm::length(offsetNow);
  if (!(distanceThen > 0) || !(distanceNow > 0)) return std::nullopt;
  const glm::dvec3 a = offsetThen / distanceThen;
  const glm::dvec3 b = offsetNow / distanceNow;
  const glm::dvec3 across = glm::cross(a, b);
  const double sine = glm::length(across);
  const double turn = std::atan2(sine, glm::dot(a, b));
  const double grown = std::log(distanceNow / distanceThen);
  const glm::dvec3 moved = now.target - then.target;
  const bool still = turn < kSmallestTurn && std::abs(grown) < kSmallestScale &&
                     glm::length(moved) < kSmallestMove * distanceNow;
  if (still) return std::nullopt;

  Camera ahead = now;
  const double limit = std::log(kLargestScale);
  const double distance = distanceNow * std::exp(std::clamp(grown * share, -limit, limit));
  glm::dvec3 direction = b;
  if (sine > kSmallestTurn)
    direction = turnedOn(b, across / sine, std::min(turn * share, kLargestTurn));
  ahead.target = now.target + moved * share;
  ahead.eye = ahead.target + direction * distance;
  return ahead;
}

}  // namespace meshfront
