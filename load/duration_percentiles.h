// Percentiles of any number of durations in constant memory: counts in classes that grow by 2 %.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>

namespace meshfront {

class DurationPercentiles {
 public:
  using Duration = std::chrono::duration<double>;  // seconds

  void add(Duration duration) {
    const double seconds = std::max(duration.count(), 0.0);
    ++counts_[classOf(seconds)];
    ++total_;
    longest_ = std::max(longest_, seconds);
  }
  [[nodiscard]] uint64_t count() const { return total_; }
  // Seconds that `percent` (above 0 to 100) of the durations do not exceed, to 2 %; 0 without any.
  [[nodiscard]] double percentile(double percent) const {
    const auto wanted =
        static_cast<uint64_t>(std::ceil(percent / 100 * static_cast<double>(total_)));
    uint64_t passed = 0;
    for (size_t i = 0; i < counts_.size(); ++i) {
      passed += counts_[i];
      if (passed >= wanted && passed > 0) return std::min(upperEnd(i), longest_);
    }
    return longest_;
  }
  [[nodiscard]] double longest() const { return longest_; }  // seconds, exact

 private:
  static constexpr double kFirst = 1e-6;  // seconds: the upper end of class 0
  static constexpr double kGrowth = 1.02;
  static constexpr size_t kClasses = 1'200;  // up to some hours

  static size_t classOf(double seconds) {
    if (seconds <= kFirst) return 0;
    const double above = std::ceil(std::log(seconds / kFirst) / std::log(kGrowth));
    return std::min(static_cast<size_t>(above), kClasses - 1);
  }
  static double upperEnd(size_t index) {
    return kFirst * std::pow(kGrowth, static_cast<double>(index));
  }

  std::array<uint64_t, kClasses> counts_{};
  uint64_t total_ = 0;
  double longest_ = 0;
};

}  // namespace meshfront
