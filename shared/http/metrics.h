// Counters and gauges, shown as Prometheus text (exposition format 0.0.4).
//
//   Counter& hits = metrics.counter("meshfront_cache_hits_total", "Records found.",
//   "kind=\"record\""); hits.add(3);
//
// Names end in the unit, counters in _total. Counting is lock-free; registering and showing are
// not.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace meshfront {

class alignas(64) Counter {  // a cache line of its own: threads count side by side
 public:
  void add(uint64_t n = 1) { value_.fetch_add(n, std::memory_order_relaxed); }
  [[nodiscard]] uint64_t value() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<uint64_t> value_{0};
};

class Metrics {
 public:
  // Counters of one name differ in `labels` (text between the braces). The reference stays valid.
  Counter& counter(const std::string& name, const std::string& help,
                   const std::string& labels = {});
  // `read` is called when the page is shown, from any thread.
  void gauge(const std::string& name, const std::string& help, std::function<uint64_t()> read);
  // Labelled counters that are still zero are left out.
  [[nodiscard]] std::string text() const;

 private:
  struct Sample {
    std::string labels;
    Counter* counter = nullptr;      // or
    std::function<uint64_t()> read;  // a gauge
  };
  struct Family {
    std::string name;
    std::string help;
    const char* type;
    std::vector<Sample> samples;
  };
  Family& family(const std::string& name, const std::string& help, const char* type);

  mutable std::mutex mutex_;
  std::deque<Counter> counters_;
  std::vector<Family> families_;
};

}  // namespace meshfront
