// How long the pictures of the last seconds took.
#pragma once

#include <deque>
#include <optional>

#include "viewer/window/panel_status.h"

namespace meshfront {

class FrameClock {
 public:
  static constexpr double kRemembered = 5;         // seconds
  static constexpr size_t kMostRemembered = 2000;  // frames

  // A picture that took `duration` was ready at `now` (seconds of a steady clock).
  void add(double now, double duration);
  // None where no picture was drawn in the last seconds.
  [[nodiscard]] std::optional<FrameTimes> times(double now) const;

 private:
  struct Frame {
    double at;
    double duration;
  };
  std::deque<Frame> frames_;
};

}  // namespace meshfront
