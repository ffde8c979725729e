#include "proxy/retrying_upstream.h"

#include <algorithm>

namespace meshfront {
namespace {

// Nothing came, or a gateway says that nothing is behind it. Timeouts are not worth repeating.
bool nothingCame(const Result<UpstreamResponse>& response) {
  if (!response) return response.error().code == ErrorCode::unavailable;
  return response->status == 502 || response->status == 503;
}

}  // namespace

RetryingUpstream::Clock::time_point RetryingUpstream::noteFailure() {
  const std::scoped_lock lock(mutex_);
  if (!awaySince_) awaySince_ = Clock::now();
  return *awaySince_ + options_.patience;
}

void RetryingUpstream::noteSuccess() {
  const std::scoped_lock lock(mutex_);
  awaySince_.reset();
}

void RetryingUpstream::stop() {
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
  }
  stopped_.notify_all();
}

Result<UpstreamResponse> RetryingUpstream::send(const UpstreamRequest& request) {
  auto pause = options_.firstPause;
  while (true) {
    auto response = upstream_.send(request);
    if (!nothingCame(response)) {
      noteSuccess();
      return response;
    }
    if (noteFailure() < Clock::now() + pause) return response;
    {
      std::unique_lock lock(mutex_);
      if (stopped_.wait_for(lock, pause, [this] { return stopping_; })) return response;
    }
    pause = std::min(pause * 2, options_.longestPause);
  }
}

}  // namespace meshfront
