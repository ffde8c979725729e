// Quality over time, kept short enough to be drawn, and how fast something grows.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "viewer/window/panel_status.h"

namespace meshfront {

class QualitySeries {
 public:
  static constexpr double kRemembered = 120;  // seconds
  static constexpr double kInterval = 0.25;   // between samples; the newest one is always exact
  // `seconds` must not go back.
  void add(double seconds, double share);
  [[nodiscard]] const std::vector<QualitySample>& samples() const { return samples_; }

 private:
  std::vector<QualitySample> samples_;
};

// Growth of a total a second, over the last seconds.
class RateMeter {
 public:
  static constexpr double kSpan = 2;  // seconds
  void add(double seconds, uint64_t total);
  // None before the second look.
  [[nodiscard]] std::optional<double> perSecond() const;

 private:
  struct Look {
    double seconds;
    uint64_t total;
  };
  std::deque<Look> looks_;
};

}  // namespace meshfront
