// What one client's download of a whole pack does to a cache of records that many receivers share:
// a simulation, the same for the proxy's cache and for plain LRU.
//
// A pack has coarse records, which every receiver asks for, the records of each of `views` views,
// looked at by receivers with Zipf's law, and others that nobody looks at. Receivers come one after
// the other; meanwhile the scan takes the pack in its order, `pace` records for each one of theirs.
#pragma once

#include <cmath>
#include <cstdint>
#include <list>
#include <memory>
#include <random>
#include <unordered_map>
#include <vector>

#include "proxy/record_cache.h"

namespace meshfront {

struct ScanPlan {
  uint32_t coarse = 4'000;
  uint32_t views = 100;
  uint32_t perView = 2'000;
  uint32_t others = 600'000;
  uint32_t capacity = 60'000;  // records
  unsigned receivers = 300;    // before the scan, and after it
  unsigned pace = 4;
  [[nodiscard]] uint32_t packRecords() const { return coarse + views * perView + others; }
};

// Shares of the receivers' records that were in the cache. `before` and `after` are of a third of
// the receivers each: the last ones, and the first ones.
struct ScanRatios {
  double before = 0;
  double during = 0;
  double after = 0;
};

class LruRecords {
 public:
  explicit LruRecords(uint32_t capacity) : capacity_(capacity) {}
  // Whether it was there; it is now.
  bool ask(uint32_t record) {
    const auto found = places_.find(record);
    if (found != places_.end()) {
      order_.splice(order_.begin(), order_, found->second);
      return true;
    }
    order_.push_front(record);
    places_[record] = order_.begin();
    if (order_.size() > capacity_) {
      places_.erase(order_.back());
      order_.pop_back();
    }
    return false;
  }

 private:
  uint32_t capacity_;
  std::list<uint32_t> order_;
  std::unordered_map<uint32_t, std::list<uint32_t>::iterator> places_;
};

class ProxyRecords {
 public:
  explicit ProxyRecords(uint32_t capacity) : budget_(capacity * kBytes), cache_(budget_) {}
  bool ask(uint32_t record) {
    RecordEntry entry;
    entry.id = nodeOf(record);
    entry.bitLength = 32;
    BitWriter out;
    if (RecordCache::Reader(cache_).find(entry.id, &out)) return true;
    cache_.insert(entry, kBits);
    if (++inserted_ % 256 == 0) budget_.enforce();
    return false;
  }

 private:
  static constexpr size_t kBytes = 38;  // of a cached record
  static constexpr std::array<uint8_t, 4> kBits{1, 2, 3, 4};
  // A thousand trees, so that all shards have their share.
  static NodeId nodeOf(uint32_t record) {
    NodeId node = NodeId::root(record % 1'000);
    for (uint32_t path = record / 1'000 + 1; path > 1; path >>= 1) node = node.child(path & 1);
    return node;
  }
  MemoryBudget budget_;
  RecordCache cache_;
  uint64_t inserted_ = 0;
};

template <typename Records>
ScanRatios simulateScan(const ScanPlan& plan) {
  Records records(plan.capacity);
  std::mt19937 random(1);
  std::vector<double> weights;
  for (uint32_t view = 0; view < plan.views; ++view) weights.push_back(1.0 / (view + 1));
  std::discrete_distribution<uint32_t> zipf(weights.begin(), weights.end());
  uint64_t asked = 0;
  uint64_t hits = 0;
  uint32_t scanned = 0;
  const auto see = [&](uint32_t record, unsigned pace) {
    ++asked;
    hits += records.ask(record) ? 1 : 0;
    for (unsigned i = 0; i < pace && scanned < plan.packRecords(); ++i) records.ask(scanned++);
  };
  const auto receive = [&](unsigned pace) {
    const uint32_t first = plan.coarse + zipf(random) * plan.perView;
    for (uint32_t i = 0; i < plan.coarse; ++i) see(i, pace);
    for (uint32_t i = 0; i < plan.perView; ++i) see(first + i, pace);
  };
  const auto ratio = [&] {
    const double value = static_cast<double>(hits) / static_cast<double>(asked);
    asked = hits = 0;
    return value;
  };
  ScanRatios ratios;
  for (unsigned i = 0; i < plan.receivers * 2 / 3; ++i) receive(0);
  static_cast<void>(ratio());
  for (unsigned i = 0; i < plan.receivers / 3; ++i) receive(0);
  ratios.before = ratio();
  while (scanned < plan.packRecords()) receive(plan.pace);
  ratios.during = ratio();
  for (unsigned i = 0; i < plan.receivers / 3; ++i) receive(0);
  ratios.after = ratio();
  return ratios;
}

}  // namespace meshfront
