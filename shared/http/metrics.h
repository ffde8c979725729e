// Counters, gauges and histograms, shown as Prometheus text (exposition format 0.0.4).
//
//   Counter& hits = metrics.counter("meshfront_cache_hits_total", "Records found.",
//   "kind=\"record\""); hits.add(3);
//
// Names end in the unit, counters in _total. Counting is lock-free; registering and showing are
// not.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <span>
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

// Durations, counted in buckets. Threads count in parts of their own, which are summed when shown.
class Histogram {
 public:
  static constexpr size_t kMaxBounds = 20;
  // `bounds`: upper ends of the buckets in seconds, rising, at most kMaxBounds; one bucket without
  // an end follows.
  explicit Histogram(std::span<const double> bounds);
  void observe(std::chrono::nanoseconds duration);

  struct Sums {
    std::vector<uint64_t> upTo;  // observations at or below each bound, then all
    double seconds = 0;
  };
  [[nodiscard]] Sums sums() const;
  [[nodiscard]] std::span<const double> bounds() const { return bounds_; }

 private:
  static constexpr size_t kParts = 8;
  struct alignas(64) Part {
    std::array<std::atomic<uint64_t>, kMaxBounds + 1> counts{};
    std::atomic<uint64_t> nanoseconds{0};
  };
  const std::vector<double> bounds_;
  std::array<int64_t, kMaxBounds> limits_{};  // the bounds in nanoseconds
  std::array<Part, kParts> parts_;
};

// 100 us to 10 s: what serving and fetching take.
inline constexpr std::array<double, 16> kLatencyBounds{
    0.0001, 0.00025, 0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025,
    0.05,   0.1,     0.25,   0.5,   1,      2.5,   5,    10};

class Metrics {
 public:
  // Counters of one name differ in `labels` (text between the braces). The reference stays valid.
  Counter& counter(const std::string& name, const std::string& help,
                   const std::string& labels = {});
  // `read` is called when the page is shown, from any thread.
  void gauge(const std::string& name, const std::string& help, std::function<uint64_t()> read);
  // A counter that is kept elsewhere.
  void countedElsewhere(const std::string& name, const std::string& help,
                        std::function<uint64_t()> read);
  // Registered once a name. The reference stays valid.
  Histogram& histogram(const std::string& name, const std::string& help,
                       std::span<const double> bounds);
  // Labelled counters that are still zero are left out.
  [[nodiscard]] std::string text() const;

 private:
  struct Sample {
    std::string labels;
    Counter* counter = nullptr;      // or
    std::function<uint64_t()> read;  // what is read when shown, or
    Histogram* histogram = nullptr;
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
  std::deque<Histogram> histograms_;
  std::vector<Family> families_;
};

}  // namespace meshfront
