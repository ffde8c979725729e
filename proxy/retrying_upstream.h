// Bridges the restart of an upstream: a request that finds no connection is repeated with growing
// pauses for a few seconds. Once the upstream has been away for longer, requests try once and fail
// at once, so that they do not pile up.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>

#include "proxy/upstream.h"

namespace meshfront {

class RetryingUpstream final : public Upstream {
 public:
  struct Options {
    std::chrono::milliseconds patience{5000};
    std::chrono::milliseconds firstPause{50};  // doubled each time
    std::chrono::milliseconds longestPause{1000};
  };
  RetryingUpstream(Upstream& upstream, Options options) : upstream_(upstream), options_(options) {}

  [[nodiscard]] Result<UpstreamResponse> send(const UpstreamRequest& request) override;
  void stop();  // no more pauses

 private:
  using Clock = std::chrono::steady_clock;
  // When to give up; the time at which the upstream was found away first counts.
  [[nodiscard]] Clock::time_point noteFailure();
  void noteSuccess();

  Upstream& upstream_;
  const Options options_;
  std::mutex mutex_;
  std::condition_variable stopped_;
  bool stopping_ = false;
  std::optional<Clock::time_point> awaySince_;
};

}  // namespace meshfront
