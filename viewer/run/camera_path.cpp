#include "viewer/run/camera_path.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/trigonometric.hpp>
#include <utility>

namespace meshfront {
namespace {

constexpr double kSameUp = 1e-9;
constexpr double kSamePlace = 1e-6;  // as a share of the distance, or radians
const double kWholeTurn = glm::radians(360.0);

glm::dquat turnOf(const Camera& camera) {
  const ViewAxes axes = viewAxes(camera);
  return glm::normalize(glm::quat_cast(glm::dmat3(axes.right, axes.upward, -axes.forward)));
}

// Two unit vectors that span the plane under `up`; azimuths go from the first to the second.
std::pair<glm::dvec3, glm::dvec3> levelAxes(const glm::dvec3& up) {
  const glm::dvec3 other = std::abs(up.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  const glm::dvec3 ahead = glm::normalize(glm::cross(other, up));
  return {ahead, glm::cross(up, ahead)};
}

bool sameView(const Camera& a, const Camera& b) {
  const double distance = glm::length(a.eye - a.target);
  const ViewAxes x = viewAxes(a);
  const ViewAxes y = viewAxes(b);
  return glm::length(a.eye - b.eye) < kSamePlace * distance &&
         glm::length(a.target - b.target) < kSamePlace * distance &&
         glm::length(x.upward - y.upward) < kSamePlace &&
         std::abs(a.verticalFov - b.verticalFov) < kSamePlace;
}

}  // namespace

Result<CameraPath> CameraPath::place(const CameraPathSpec& spec, const Bounds& bounds,
                                     double aspect) {
  CameraPath path;
  path.framesPerSecond_ = spec.framesPerSecond;
  path.smooth_ = spec.smooth;
  path.loop_ = spec.loop;
  path.rounds_ = spec.loop ? spec.rounds : 1;
  for (const PathKeyFrame& frame : spec.keyFrames) {
    Camera camera = placeCamera(frame.camera, bounds, aspect);
    if (!(glm::length(camera.eye - camera.target) > 0)) {
      return fail("camera path: the key frame at " + std::to_string(frame.time) +
                  " s has its eye at its target");
    }
    path.cameras_.push_back(camera);
    path.times_.push_back(frame.time);
  }
  path.roundSeconds_ = path.times_.back();
  path.frameCount_ =
      1 + static_cast<uint64_t>(std::floor(path.duration() * path.framesPerSecond_ + 1e-6));
  if (spec.loop && !sameView(path.cameras_.front(), path.cameras_.back())) {
    return fail(
        "camera path: a loop ends where it begins: the last key frame must have the first "
        "one's camera");
  }
  const auto ends = spec.loop ? MonotoneCurve::Ends::closed : MonotoneCurve::Ends::open;
  const auto curve = [&path, ends](const std::function<double(const Camera&)>& value) {
    std::vector<double> values;
    values.reserve(path.cameras_.size());
    for (const Camera& camera : path.cameras_) values.push_back(value(camera));
    return MonotoneCurve(path.times_, std::move(values), path.smooth_, ends);
  };
  for (int i = 0; i < 3; ++i) {
    path.target_.at(static_cast<size_t>(i)) =
        curve([i](const Camera& camera) { return camera.target[i]; });
  }
  path.logDistance_ =
      curve([](const Camera& camera) { return std::log(glm::length(camera.eye - camera.target)); });
  path.logTangent_ =
      curve([](const Camera& camera) { return std::log(std::tan(0.5 * camera.verticalFov)); });
  const glm::dvec3 up = glm::normalize(path.cameras_.front().up);
  path.aroundTargets_ =
      std::all_of(path.cameras_.begin(), path.cameras_.end(), [&up](const Camera& camera) {
        return glm::length(glm::normalize(camera.up) - up) < kSameUp;
      });
  if (path.aroundTargets_) {
    path.turnAroundTargets(spec);
  } else {
    path.turnWholeCameras();
  }
  return path;
}

void CameraPath::turnAroundTargets(const CameraPathSpec& spec) {
  const glm::dvec3 up = glm::normalize(cameras_.front().up);
  const auto [ahead, side] = levelAxes(up);
  std::vector<double> azimuths;
  std::vector<double> elevations;
  for (size_t i = 0; i < cameras_.size(); ++i) {
    const glm::dvec3 toEye = glm::normalize(cameras_[i].eye - cameras_[i].target);
    const glm::dvec3 level = toEye - up * glm::dot(toEye, up);
    double azimuth = std::atan2(glm::dot(toEye, side), glm::dot(toEye, ahead));
    if (i > 0) {
      const bool written = !spec.keyFrames[i - 1].camera.eye && !spec.keyFrames[i].camera.eye;
      const double before = azimuths.back();
      // From straight above, any direction is as good as the one before.
      if (!written && glm::length(level) < kSamePlace) azimuth = before;
      const double near = written ? before + glm::radians(spec.keyFrames[i].camera.azimuth -
                                                          spec.keyFrames[i - 1].camera.azimuth)
                                  : before;
      azimuth += kWholeTurn * std::round((near - azimuth) / kWholeTurn);
    }
    azimuths.push_back(azimuth);
    elevations.push_back(std::asin(std::clamp(glm::dot(toEye, up), -1.0, 1.0)));
  }
  const auto ends = loop_ ? MonotoneCurve::Ends::closed : MonotoneCurve::Ends::open;
  azimuth_ = MonotoneCurve(times_, std::move(azimuths), smooth_, ends);
  elevation_ = MonotoneCurve(times_, std::move(elevations), smooth_, ends);
}

// Component by component on one side of the quaternions' sphere, where lines and curves stay far
// from its middle: neighbours are at most a quarter of it apart.
void CameraPath::turnWholeCameras() {
  std::vector<glm::dquat> turns;
  for (const Camera& camera : cameras_) {
    const glm::dquat turn = turnOf(camera);
    const bool otherSide = !turns.empty() && glm::dot(turn, turns.back()) < 0;
    turns.push_back(otherSide ? -turn : turn);
  }
  auto ends = MonotoneCurve::Ends::open;
  if (loop_) {
    ends = glm::dot(turns.front(), turns.back()) < 0 ? MonotoneCurve::Ends::mirrored
                                                     : MonotoneCurve::Ends::closed;
  }
  for (int i = 0; i < 4; ++i) {
    std::vector<double> values;
    values.reserve(turns.size());
    for (const glm::dquat& turn : turns) values.push_back(turn[i]);
    turn_.at(static_cast<size_t>(i)) = MonotoneCurve(times_, std::move(values), smooth_, ends);
  }
}

glm::dquat CameraPath::turnAt(double seconds) const {
  glm::dquat turn;
  for (int i = 0; i < 4; ++i) turn[i] = turn_.at(static_cast<size_t>(i)).at(seconds);
  return glm::normalize(turn);
}

Camera CameraPath::at(double seconds) const {
  double time = std::clamp(seconds, 0.0, duration());
  if (loop_ && time > roundSeconds_) {
    time = std::fmod(time, roundSeconds_);
  }
  Camera camera;
  camera.target = {target_[0].at(time), target_[1].at(time), target_[2].at(time)};
  camera.verticalFov = 2 * std::atan(std::exp(logTangent_.at(time)));
  const double distance = std::exp(logDistance_.at(time));
  if (aroundTargets_) {
    camera.up = cameras_.front().up;
    const glm::dvec3 up = glm::normalize(camera.up);
    const auto [ahead, side] = levelAxes(up);
    const double azimuth = azimuth_.at(time);
    const double elevation = elevation_.at(time);
    camera.eye =
        camera.target +
        distance * (std::cos(elevation) * (std::cos(azimuth) * ahead + std::sin(azimuth) * side) +
                    std::sin(elevation) * up);
    return camera;
  }
  const glm::dmat3 axes = glm::mat3_cast(turnAt(time));
  camera.up = axes[1];
  camera.eye = camera.target + distance * axes[2];
  return camera;
}

}  // namespace meshfront
