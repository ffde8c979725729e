#include "load/measured_transport.h"

#include <chrono>
#include <utility>

namespace meshfront {
namespace {

using LatencyClock = std::chrono::steady_clock;

bool asksForRecords(const std::string& url) {
  return url.find("/splits") != std::string::npos || url.find("/chunks/") != std::string::npos;
}

std::string errorKind(const FetchResponse& response) {
  if (response.status == 0) return "no answer";
  return response.status == 200 ? std::string() : "status " + std::to_string(response.status);
}

}  // namespace

FetchId MeasuredTransport::send(FetchRequest request, Completion completion) {
  const LatencyClock::time_point begin = LatencyClock::now();
  const bool records = asksForRecords(request.url);
  auto counted = [state = state_, begin, records,
                  completion = std::move(completion)](FetchResponse response) {
    {
      const std::string kind = errorKind(response);
      const std::lock_guard lock(state->mutex);
      TransportCounts& counts = state->counts;
      ++counts.requests;
      if (response.traffic.attempts > 1) counts.repeated += response.traffic.attempts - 1;
      counts.traffic += response.traffic;
      if (!kind.empty()) ++counts.errors[kind];
      if (kind.empty() && records) {
        ++counts.recordAnswers;
        counts.recordBytes += response.body.size();
      }
      counts.latency.add(LatencyClock::now() - begin);
    }
    completion(std::move(response));
  };
  return inner_.send(std::move(request), std::move(counted));
}

TransportCounts MeasuredTransport::counts() const {
  const std::lock_guard lock(state_->mutex);
  return state_->counts;
}

}  // namespace meshfront
