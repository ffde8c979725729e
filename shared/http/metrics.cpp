#include "shared/http/metrics.h"

#include <algorithm>
#include <cstdio>

namespace meshfront {
namespace {

// Threads take the parts of histograms in turn.
size_t partOfThread(size_t parts) {
  static std::atomic<size_t> threads{0};
  thread_local const size_t number = threads.fetch_add(1, std::memory_order_relaxed);
  return number % parts;
}

std::string decimal(const char* format, double value) {
  std::array<char, 64> text{};
  const int length = std::snprintf(text.data(), text.size(), format, value);
  return {text.data(), static_cast<size_t>(std::clamp(length, 0, 63))};
}

void appendHistogram(std::string& out, const std::string& name, const Histogram& histogram) {
  const Histogram::Sums sums = histogram.sums();
  const auto bounds = histogram.bounds();
  for (size_t i = 0; i < sums.upTo.size(); ++i) {
    const std::string end = i < bounds.size() ? decimal("%g", bounds[i]) : "+Inf";
    out += name + "_bucket{le=\"" + end + "\"} " + std::to_string(sums.upTo[i]) + "\n";
  }
  out += name + "_sum " + decimal("%.9f", sums.seconds) + "\n";
  out += name + "_count " + std::to_string(sums.upTo.back()) + "\n";
}

}  // namespace

Histogram::Histogram(std::span<const double> bounds)
    : bounds_(bounds.begin(),
              bounds.begin() + static_cast<ptrdiff_t>(std::min(bounds.size(), kMaxBounds))) {
  limits_.fill(INT64_MAX);
  for (size_t i = 0; i < bounds_.size(); ++i) limits_[i] = static_cast<int64_t>(bounds_[i] * 1e9);
}

void Histogram::observe(std::chrono::nanoseconds duration) {
  const int64_t nanoseconds = std::max<int64_t>(duration.count(), 0);
  size_t bucket = 0;
  while (bucket < bounds_.size() && nanoseconds > limits_[bucket]) ++bucket;
  Part& part = parts_[partOfThread(kParts)];
  part.counts[bucket].fetch_add(1, std::memory_order_relaxed);
  part.nanoseconds.fetch_add(static_cast<uint64_t>(nanoseconds), std::memory_order_relaxed);
}

Histogram::Sums Histogram::sums() const {
  Sums sums{std::vector<uint64_t>(bounds_.size() + 1), 0};
  uint64_t nanoseconds = 0;
  for (const Part& part : parts_) {
    for (size_t i = 0; i < sums.upTo.size(); ++i)
      sums.upTo[i] += part.counts[i].load(std::memory_order_relaxed);
    nanoseconds += part.nanoseconds.load(std::memory_order_relaxed);
  }
  for (size_t i = 1; i < sums.upTo.size(); ++i) sums.upTo[i] += sums.upTo[i - 1];
  sums.seconds = static_cast<double>(nanoseconds) / 1e9;
  return sums;
}

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
  owner.samples.push_back({labels, &counter, {}, nullptr});
  return counter;
}

void Metrics::gauge(const std::string& name, const std::string& help,
                    std::function<uint64_t()> read) {
  const std::scoped_lock lock(mutex_);
  family(name, help, "gauge").samples.push_back({{}, nullptr, std::move(read), nullptr});
}

void Metrics::countedElsewhere(const std::string& name, const std::string& help,
                               std::function<uint64_t()> read) {
  const std::scoped_lock lock(mutex_);
  family(name, help, "counter").samples.push_back({{}, nullptr, std::move(read), nullptr});
}

Histogram& Metrics::histogram(const std::string& name, const std::string& help,
                              std::span<const double> bounds) {
  const std::scoped_lock lock(mutex_);
  Family& owner = family(name, help, "histogram");
  if (!owner.samples.empty()) return *owner.samples.front().histogram;
  Histogram& histogram = histograms_.emplace_back(bounds);
  owner.samples.push_back({{}, nullptr, {}, &histogram});
  return histogram;
}

std::string Metrics::text() const {
  const std::scoped_lock lock(mutex_);
  std::string out;
  for (const Family& family : families_) {
    out += "# HELP " + family.name + " " + family.help + "\n";
    out += "# TYPE " + family.name + " " + family.type + "\n";
    for (const Sample& sample : family.samples) {
      if (sample.histogram != nullptr) {
        appendHistogram(out, family.name, *sample.histogram);
        continue;
      }
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
