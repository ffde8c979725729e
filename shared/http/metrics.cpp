#include "shared/http/metrics.h"

#include <algorithm>

namespace meshfront {

Metrics::Family& Metrics::family(const std::string& name, const std::string& help,
                                 const char* type) {
  const auto it = std::find_if(families_.begin(), families_.end(),
                               [&](const Family& f) { return f.name == name; });
  if (it != families_.end()) return *it;
  return families_.emplace_back(Family{name, help, type, {}});
}

Counter& Metrics::counter(const std::string& name, const std::string& help,
                          const std::string& labels) {
  const std::scoped_lock lock(mutex_);
  Family& owner = family(name, help, "counter");
  for (const Sample& sample : owner.samples)
    if (sample.counter != nullptr && sample.labels == labels) return *sample.counter;
  Counter& counter = counters_.emplace_back();
  owner.samples.push_back({labels, &counter, {}});
  return counter;
}

void Metrics::gauge(const std::string& name, const std::string& help,
                    std::function<uint64_t()> read) {
  const std::scoped_lock lock(mutex_);
  family(name, help, "gauge").samples.push_back({{}, nullptr, std::move(read)});
}

std::string Metrics::text() const {
  const std::scoped_lock lock(mutex_);
  std::string out;
  for (const Family& family : families_) {
    out += "# HELP " + family.name + " " + family.help + "\n";
    out += "# TYPE " + family.name + " " + family.type + "\n";
    for (const Sample& sample : family.samples) {
      const uint64_t value = sample.counter != nullptr ? sample.counter->value() : sample.read();
      if (value == 0 && !sample.labels.empty()) continue;
      out += family.name;
      if (!sample.labels.empty()) out += "{" + sample.labels + "}";
      out += " " + std::to_string(value) + "\n";
    }
  }
  return out;
}

}  // namespace meshfront
