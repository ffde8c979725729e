#include "tests/evaluation/quality/listed_way.h"

#include <random>
#include <utility>

namespace meshfront::evaluation {

Result<std::unique_ptr<ListedWay>> ListedWay::create(const PackRecords& pack,
                                                     std::vector<RecordIndex> order, Easel& easel,
                                                     const EvaluationView& view,
                                                     CountedService* service) {
  Result<RefinedPack> refined = RefinedPack::fromBase(pack);
  if (!refined) return tl::unexpected(refined.error());
  std::unique_ptr<ListedWay> way(new ListedWay(std::move(*refined), std::move(order), easel, view));
  if (service != nullptr) {
    const Result<ExchangeBytes> metadata = service->metadata();
    if (!metadata) return tl::unexpected(metadata.error());
    const Result<ExchangeBytes> base = service->base();
    if (!base) return tl::unexpected(base.error());
    way->countsBytes_ = true;
    // The fields of the long answer are counted with it.
    way->setupBytes_ = metadata->down + base->down + service->fieldBytes();
    way->cost_.bytesUp = metadata->up + 2 * base->up;
  }
  way->cost_.bytesDown = way->setupBytes_;
  return way;
}

Result<bool> ListedWay::advance(uint64_t untilBytes) {
  if (next_ == order_.size()) return false;
  while (next_ < order_.size() && cost_.bytesDown < untilBytes) {
    const RecordIndex record = order_[next_++];
    if (Result<void> done = refined_.split(record); !done) return tl::unexpected(done.error());
    ++cost_.records;
    bits_ += refined_.pack().records()[record].entry.bitLength;
    cost_.bytesDown = setupBytes_ + (countsBytes_ ? (bits_ + 7) / 8 : cost_.records);
  }
  return true;
}

std::vector<RecordIndex> randomOrder(std::span<const PackRecord> records, uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<RecordIndex> ready;
  for (RecordIndex i = 0; i < records.size(); ++i)
    if (records[i].parent == kNoRecord) ready.push_back(i);
  std::vector<RecordIndex> order;
  order.reserve(records.size());
  while (!ready.empty()) {
    const size_t at = std::uniform_int_distribution<size_t>(0, ready.size() - 1)(random);
    const RecordIndex record = std::exchange(ready[at], ready.back());
    ready.pop_back();
    order.push_back(record);
    for (const RecordIndex child : records[record].children)
      if (child != kNoRecord) ready.push_back(child);
  }
  return order;
}

}  // namespace meshfront::evaluation
