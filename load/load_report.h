// What a load run came to, for people and for scripts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "load/load_options.h"
#include "load/load_run.h"
#include "load/measured_transport.h"
#include "load/metrics_page.h"

namespace meshfront {

// A server's counters around the run.
struct MetricsSpan {
  MetricsPage before;
  MetricsPage after;
  [[nodiscard]] double grown(std::string_view name, std::string_view label = {}) const {
    return after.sum(name, label) - before.sum(name, label);
  }
};

struct LoadReport {
  const LoadOptions* options = nullptr;
  LoadResult result;
  TransportCounts transport;
  uint64_t peakMemory = 0;  // octets, of this process
  std::optional<MetricsSpan> origin;
  std::optional<MetricsSpan> proxy;
};

// Octets of records that a service or a proxy sent, as sets of nodes or as chunks.
[[nodiscard]] double recordBytesServed(const MetricsSpan& span);

[[nodiscard]] std::string toText(const LoadReport& report);  // lines
[[nodiscard]] std::string toJson(const LoadReport& report);  // one object, one line
// For each second of the run.
[[nodiscard]] std::string progressLine(const LoadResult& result, const TransportCounts& counts,
                                       const TransportCounts& aSecondAgo);

}  // namespace meshfront
