#include "shared/receiver/link_meter.h"

#include <algorithm>
#include <cmath>

namespace meshfront {
namespace {

constexpr size_t kMostSamples = 256;
// A link that a window just fills looks no faster than one that it leaves idle: a little more is
// asked for than was seen to fit, and one request more because answers are whole.
constexpr double kProbing = 1.25;
constexpr std::chrono::microseconds kShortestTime{50};

}  // namespace

void LinkMeter::observe(const FetchResponse& response) {
  const FetchTiming& timing = response.timing;
  if (response.status != 200 || !timing.known() || timing.done < timing.firstByte) return;
  Sample sample;
  sample.done = timing.done;
  sample.bytes = response.traffic.bytesDown();
  sample.roundTrip = timing.firstByte - timing.sent;
  // Everything that arrived while this one was under way shared the link with it.
  uint64_t delivered = sample.bytes;
  for (const Sample& other : samples_)
    if (other.done > timing.sent && other.done <= timing.done) delivered += other.bytes;
  const std::chrono::duration<double> took =
      std::max<Clock::duration>(timing.done - timing.sent, kShortestTime);
  sample.bytesPerSecond = static_cast<double>(delivered) / took.count();
  samples_.push_back(sample);
  while (samples_.size() > kMostSamples || samples_.front().done + kMemory < sample.done)
    samples_.pop_front();
}

std::optional<std::chrono::nanoseconds> LinkMeter::roundTrip() const {
  if (samples_.empty()) return std::nullopt;
  return std::min_element(
             samples_.begin(), samples_.end(),
             [](const Sample& a, const Sample& b) { return a.roundTrip < b.roundTrip; })
      ->roundTrip;
}

std::optional<double> LinkMeter::bytesPerSecond() const {
  if (samples_.empty()) return std::nullopt;
  return std::max_element(
             samples_.begin(), samples_.end(),
             [](const Sample& a, const Sample& b) { return a.bytesPerSecond < b.bytesPerSecond; })
      ->bytesPerSecond;
}

double LinkMeter::productBytes() const {
  if (samples_.empty()) return 0;
  return *bytesPerSecond() * std::chrono::duration<double>(*roundTrip()).count();
}

std::optional<uint32_t> LinkMeter::window(double answerBytes) const {
  if (samples_.empty() || answerBytes <= 0) return std::nullopt;
  const double busy = std::ceil(kProbing * productBytes() / answerBytes) + 1;
  return static_cast<uint32_t>(std::clamp(busy, 1.0, static_cast<double>(kWidestWindow)));
}

}  // namespace meshfront
