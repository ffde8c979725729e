// Where the camera will be: the motion of the last moments goes on.
#pragma once

#include <deque>
#include <optional>

#include "shared/camera/camera.h"

namespace meshfront {

class ViewPrediction {
 public:
  // `seconds` on any clock that does not go back.
  void see(double seconds, const Camera& camera);
  // The view `ahead` seconds after the last one seen: the target goes on moving, the eye goes on
  // turning around it and coming nearer or going away. Turns by at most kLargestTurn and scales the
  // distance by at most kLargestScale. nullopt while the camera stands still.
  [[nodiscard]] std::optional<Camera> ahead(double seconds) const;

  static constexpr double kMemory = 0.5;        // seconds of motion that count
  static constexpr double kLargestTurn = 1.05;  // radians
  static constexpr double kLargestScale = 2;

 private:
  struct Seen {
    double seconds = 0;
    Camera camera;
  };
  std::deque<Seen> seen_;
};

}  // namespace meshfront
