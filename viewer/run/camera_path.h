// A camera's path over time, from a JSON file of key frames, sampled at any moment.
//
//   {"frames_per_second": 30,
//    "key_frames": [{"time": 0, "camera": "azimuth=30;elevation=20"},
//                   {"time": 2, "eye": [0, 1, 5], "target": [0, 0, 0], "fov": 35}],
//    "interpolation": "smooth", "loop": false, "rounds": 1}
//
//   auto spec = parseCameraPath(text, "tour.json");  // before anything is known of a mesh
//   auto path = CameraPath::place(*spec, bounds, aspect);
//   for (uint64_t k = 0; k < path->frameCount(); ++k) draw(path->at(path->frameTime(k)));
//
// A key frame has a "time" in seconds and either a "camera" as --camera has it, or any of eye,
// target, up (world) and fov (degrees). In between, targets move on a curve, the eye goes around
// them: as one goes around an object where all key frames share their up vector (azimuths are taken
// as they are written, so 0 to 360 is a whole turn; without any, the shorter way), by turning the
// whole camera where they do not. Distances change by equal factors in equal times.
//
// "smooth" (default): cubic curves that overshoot nothing between two key frames
// (monotone_curve.h), of quaternions where the whole camera turns. "linear": with corners. "loop":
// the last key frame is the first one's camera, and the curve closes smoothly; it is then played
// "rounds" times.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <glm/gtc/quaternion.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "shared/camera/bounds.h"
#include "shared/camera/camera.h"
#include "shared/camera/camera_spec.h"
#include "shared/result.h"
#include "viewer/run/monotone_curve.h"

namespace meshfront {

struct PathKeyFrame {
  double time = 0;  // seconds
  CameraSpec camera;
};

struct CameraPathSpec {
  double framesPerSecond = 30;
  std::vector<PathKeyFrame> keyFrames;  // one or more, by ascending time from 0
  bool smooth = true;
  bool loop = false;
  uint32_t rounds = 1;
};

inline constexpr size_t kMaxPathBytes = 4 << 20;
inline constexpr size_t kMaxKeyFrames = 10'000;
inline constexpr uint64_t kMaxPathFrames = 1'000'000;

// Untrusted; nothing unknown is accepted. Messages begin with `name` and say which key frame is
// wrong and what may stand there.
[[nodiscard]] Result<CameraPathSpec> parseCameraPath(std::string_view json,
                                                     const std::string& name);
[[nodiscard]] Result<CameraPathSpec> readCameraPath(const std::filesystem::path& file);

class CameraPath {
 public:
  // An error where a loop does not close.
  [[nodiscard]] static Result<CameraPath> place(const CameraPathSpec& spec, const Bounds& bounds,
                                                double aspect);

  [[nodiscard]] double duration() const { return roundSeconds_ * rounds_; }  // seconds
  [[nodiscard]] uint64_t frameCount() const { return frameCount_; }          // at least one
  [[nodiscard]] double frameTime(uint64_t frame) const {
    return static_cast<double>(frame) / framesPerSecond_;
  }
  [[nodiscard]] double framesPerSecond() const { return framesPerSecond_; }
  // Before the start the first camera, after the end the last one.
  [[nodiscard]] Camera at(double seconds) const;

 private:
  CameraPath() = default;
  void turnAroundTargets(const CameraPathSpec& spec);
  void turnWholeCameras();
  [[nodiscard]] glm::dquat turnAt(double seconds) const;

  std::vector<Camera> cameras_;  // of the key frames
  std::vector<double> times_;
  double framesPerSecond_ = 30;
  double roundSeconds_ = 0;
  uint32_t rounds_ = 1;
  uint64_t frameCount_ = 1;
  bool smooth_ = true;
  bool loop_ = false;
  bool aroundTargets_ = true;
  std::array<MonotoneCurve, 3> target_;
  MonotoneCurve logDistance_;
  MonotoneCurve logTangent_;  // of half the field of view
  MonotoneCurve azimuth_;     // radians around the common up, from any direction
  MonotoneCurve elevation_;
  std::array<MonotoneCurve, 4> turn_;  // a quaternion's components
};

}  // namespace meshfront
