#include "proxy/timed_upstream.h"

namespace meshfront {

TimedUpstream::TimedUpstream(Upstream& upstream, Metrics& metrics)
    : upstream_(upstream),
      underWay_(std::make_shared<std::atomic<uint64_t>>(0)),
      seconds_(metrics.histogram("meshfront_upstream_seconds",
                                 "Time of each attempt to get an answer from upstream, failed ones "
                                 "included.",
                                 kLatencyBounds)),
      failures_(metrics.counter("meshfront_upstream_failures_total",
                                "Attempts that got no whole answer from upstream.")) {
  metrics.gauge("meshfront_upstream_in_flight", "Upstream requests under way.",
                [underWay = underWay_] { return underWay->load(); });
}

Result<UpstreamResponse> TimedUpstream::send(const UpstreamRequest& request) {
  const auto begin = std::chrono::steady_clock::now();
  ++*underWay_;
  auto response = upstream_.send(request);
  --*underWay_;
  seconds_.observe(std::chrono::steady_clock::now() - begin);
  if (!response) failures_.add();
  return response;
}

}  // namespace meshfront
