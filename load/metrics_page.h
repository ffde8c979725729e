// The counters of a service or a proxy, read from its /metrics (Prometheus text).
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "shared/receiver/transport.h"
#include "shared/result.h"

namespace meshfront {

class MetricsPage {
 public:
  // Untrusted: lines that are no samples are passed over.
  [[nodiscard]] static MetricsPage parse(std::string_view text);
  // GET {origin}/metrics and waits for the answer.
  [[nodiscard]] static Result<MetricsPage> fetch(const std::string& origin, Transport& transport);

  // Sum over all label sets of a metric that contain `label`, such as route="chunk"; 0 if there is
  // none.
  [[nodiscard]] double sum(std::string_view name, std::string_view label = {}) const;

 private:
  std::map<std::string, double, std::less<>> samples_;  // by name with labels
};

}  // namespace meshfront
