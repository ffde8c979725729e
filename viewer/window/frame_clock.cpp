#include "viewer/window/frame_clock.h"

#include <algorithm>
#include <vector>

namespace meshfront {

void FrameClock::add(double now, double duration) {
  frames_.push_back({now, duration});
  while (frames_.size() > kMostRemembered || frames_.front().at < now - kRemembered) {
    frames_.pop_front();
  }
}

std::optional<FrameTimes> FrameClock::times(double now) const {
  std::vector<double> durations;
  durations.reserve(frames_.size());
  for (const Frame& frame : frames_) {
    if (frame.at >= now - kRemembered) durations.push_back(frame.duration);
  }
  if (durations.empty()) return std::nullopt;
  std::sort(durations.begin(), durations.end());
  // The smallest that at least this share of them does not exceed.
  const auto percentile = [&durations](size_t percent) {
    return durations[(durations.size() * percent + 99) / 100 - 1];
  };
  return FrameTimes{percentile(50), percentile(95), durations.size()};
}

}  // namespace meshfront
