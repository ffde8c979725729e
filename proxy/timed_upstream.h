// Counts what an upstream takes: time, requests under way, failures.
#pragma once

#include <atomic>
#include <memory>

#include "proxy/upstream.h"
#include "shared/http/metrics.h"

namespace meshfront {

class TimedUpstream final : public Upstream {
 public:
  // Both must outlive it.
  TimedUpstream(Upstream& upstream, Metrics& metrics);
  [[nodiscard]] Result<UpstreamResponse> send(const UpstreamRequest& request) override;

 private:
  Upstream& upstream_;
  const std::shared_ptr<std::atomic<uint64_t>> underWay_;
  Histogram& seconds_;
  Counter& failures_;
};

}  // namespace meshfront
