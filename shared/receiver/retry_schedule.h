// How long to wait before a request is sent again: doubling delays with jitter, so that many
// receivers that lost the same server do not come back at the same instant.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <random>

namespace meshfront {

struct RetryPolicy {
  unsigned attempts = 6;                     // in all; 1 = never again
  std::chrono::milliseconds first{100};      // longest wait before the second attempt
  std::chrono::milliseconds longest{5'000};  // of any wait, a server's Retry-After included
};

class RetrySchedule {
 public:
  explicit RetrySchedule(RetryPolicy policy, uint64_t seed) : policy_(policy), random_(seed) {}

  [[nodiscard]] bool mayRetry(unsigned attemptsMade) const {
    return attemptsMade < policy_.attempts;
  }
  // Between half of and the whole doubled delay; at least what the server asked for.
  [[nodiscard]] std::chrono::milliseconds delay(unsigned attemptsMade,
                                                std::chrono::milliseconds retryAfter) {
    const unsigned doublings = std::clamp(attemptsMade, 1U, 16U) - 1;
    const int64_t whole = std::min(policy_.first.count() << doublings, policy_.longest.count());
    std::uniform_int_distribution<int64_t> jitter(whole / 2, whole);
    const std::chrono::milliseconds wait(jitter(random_));
    return std::min(std::max(wait, retryAfter), policy_.longest);
  }

 private:
  RetryPolicy policy_;
  std::minstd_rand random_;
};

}  // namespace meshfront
