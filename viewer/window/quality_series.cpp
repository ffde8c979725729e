#include "viewer/window/quality_series.h"

#include <algorithm>

namespace meshfront {

void QualitySeries::add(double seconds, double share) {
  // The newest sample moves on until it is far enough from the one before.
  const size_t count = samples_.size();
  if (count >= 2 && samples_[count - 1].seconds - samples_[count - 2].seconds < kInterval) {
    samples_.pop_back();
  }
  samples_.push_back({seconds, share});
  const auto old = std::find_if(samples_.begin(), samples_.end(), [seconds](const auto& sample) {
    return sample.seconds >= seconds - kRemembered;
  });
  samples_.erase(samples_.begin(), old);
}

void RateMeter::add(double seconds, uint64_t total) {
  looks_.push_back({seconds, total});
  // The newest of those that are old enough stays, to measure from.
  while (looks_.size() > 2 && looks_[1].seconds <= seconds - kSpan) looks_.pop_front();
}

std::optional<double> RateMeter::perSecond() const {
  if (looks_.size() < 2) return std::nullopt;
  const double time = looks_.back().seconds - looks_.front().seconds;
  if (!(time > 0) || looks_.back().total < looks_.front().total) return std::nullopt;
  return static_cast<double>(looks_.back().total - looks_.front().total) / time;
}

}  // namespace meshfront
