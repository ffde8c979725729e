// When to try again after a receiver has degraded: after doubling delays with jitter, for as long
// as it takes.
//
//   AutomaticResume resume;
//   while (running) {
//     receiver.advance();
//     resume.tend(receiver, std::chrono::steady_clock::now());
//     wait(resume.nextResumeAfter(...));
//   }
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "shared/receiver/receiver.h"
#include "shared/receiver/retry_schedule.h"

namespace meshfront {

class AutomaticResume {
 public:
  using Clock = std::chrono::steady_clock;
  // The policy's attempts do not matter here.
  static constexpr RetryPolicy kPolicy{0, std::chrono::milliseconds(1'000),
                                       std::chrono::milliseconds(30'000)};

  explicit AutomaticResume(RetryPolicy policy = kPolicy);
  AutomaticResume(RetryPolicy policy, uint64_t seed) : schedule_(policy, seed) {}

  // In every turn of the loop. True: the receiver has been resumed just now.
  bool tend(Receiver& receiver, Clock::time_point now);
  // How long tend() has nothing to do; nullopt: until the receiver degrades.
  [[nodiscard]] std::optional<std::chrono::milliseconds> nextResumeAfter(
      Clock::time_point now) const;

 private:
  RetrySchedule schedule_;
  unsigned attempts_ = 0;  // since an answer came
  uint64_t bytesThen_ = 0;
  std::optional<Clock::time_point> due_;
};

}  // namespace meshfront
