// A service at the end of a link with a round trip and a bandwidth, in time that only the test
// moves.
#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <utility>

#include "tests/unit/mesh_service.h"

namespace meshfront {

class DelayedService final : public Transport {
 public:
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;

  DelayedService(const MeshService& service, Seconds roundTrip, double bytesPerSecond)
      : service_(service), roundTrip_(roundTrip), bytesPerSecond_(bytesPerSecond) {}

  [[nodiscard]] FetchId send(FetchRequest request, Completion completion) override {
    Held held{++last_, {}, std::move(completion), {}};
    const Clock::time_point there = now_ + ticks(roundTrip_ / 2);
    held.response = service_.answer(request);
    urls.push_back(request.url);
    const Clock::time_point begin = std::max(there, linkFree_);
    const double bytes = static_cast<double>(held.response.traffic.bytesDown());
    linkFree_ = begin + ticks(Seconds(bytes / bytesPerSecond_));
    held.response.timing = {now_, begin + ticks(roundTrip_ / 2), linkFree_ + ticks(roundTrip_ / 2)};
    bytesSent += held.response.traffic.bytesDown();
    held.due = held.response.timing.done;
    held_.push_back(std::move(held));
    most = std::max(most, held_.size());
    return last_;
  }
  void cancel(FetchId id) override {
    std::erase_if(held_, [id](const Held& held) { return held.id == id; });
  }
  // Lets time go by until the next answer arrives. False: none is under way.
  bool deliver() {
    if (held_.empty()) return false;
    Held next = std::move(held_.front());
    held_.pop_front();
    now_ = std::max(now_, next.due);
    next.completion(std::move(next.response));
    return true;
  }
  void pass(Seconds time) { now_ += ticks(time); }

  [[nodiscard]] Clock::time_point now() const { return now_; }
  [[nodiscard]] size_t underWay() const { return held_.size(); }
  size_t most = 0;  // under way at a time
  std::vector<std::string> urls;
  uint64_t bytesSent = 0;  // of all answers, given up ones too

 private:
  struct Held {
    FetchId id;
    FetchResponse response;
    Completion completion;
    Clock::time_point due;
  };
  static Clock::duration ticks(Seconds time) {
    return std::chrono::duration_cast<Clock::duration>(time);
  }

  const MeshService& service_;
  const Seconds roundTrip_;
  const double bytesPerSecond_;
  Clock::time_point now_{std::chrono::hours(1)};
  Clock::time_point linkFree_{};
  std::deque<Held> held_;  // in the order of their arrival
  FetchId last_ = 0;
};

}  // namespace meshfront
