// The records of one mesh revision that the proxy holds, about 40 bytes each, bits included.
//
// Locking: shards by tree, each with a shared lock. A Reader keeps the lock of the tree it read
// last, because requests come sorted by tree; it must not live while the same thread inserts.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <shared_mutex>
#include <span>

#include "proxy/segmented_clock.h"
#include "shared/bits/bit_writer.h"
#include "shared/codec/chunk.h"
#include "shared/store/memory_budget.h"
#include "shared/store/node_table.h"
#include "shared/store/request_walk.h"

namespace meshfront {

class RecordCache final : private MemoryBudget::Member {
  // 0 .. 64 bits stand in `bits`, left-aligned; longer records in an allocation of their own.
  struct CachedRecord {
    uint32_t packed = 0;  // length (14), leaf flags (2), children's levels (5 each), marks
    alignas(4) std::array<uint32_t, 2> bits{};

    [[nodiscard]] uint32_t length() const { return packed >> 18; }
    [[nodiscard]] ChildFacts children() const {
      return {(packed >> 17 & 1) != 0, (packed >> 16 & 1) != 0,
              static_cast<uint8_t>(packed >> 11 & 31), static_cast<uint8_t>(packed >> 6 & 31)};
    }
    // Marks: a bit for each of the first two uses, so that they can be set without a count, and one
    // for proven (SegmentedClock).
    static constexpr uint32_t kFirstUse = 1;
    static constexpr uint32_t kSecondUse = 2;
    static constexpr uint32_t kProven = 4;
    [[nodiscard]] bool wasUsed() const { return (packed & kFirstUse) != 0; }
    [[nodiscard]] uint32_t nextUse() const { return !wasUsed() ? kFirstUse : ~packed & kSecondUse; }
    void takeUse() { packed &= (packed & kSecondUse) != 0 ? ~kSecondUse : ~kFirstUse; }
    [[nodiscard]] bool isProven() const { return (packed & kProven) != 0; }
    void prove() { packed = (packed & ~(kFirstUse | kSecondUse)) | kProven; }
    [[nodiscard]] bool isInline() const { return length() <= 64; }
  };
  static constexpr size_t kShards = 32;
  struct Shard {
    std::shared_mutex mutex;
    NodeTable<CachedRecord> table;
    SegmentedClock eviction;
    size_t outside = 0;  // bytes of the records' own allocations
    [[nodiscard]] size_t bytes() const { return table.bytes() + outside; }
  };

 public:
  static constexpr uint32_t kMaxLength = (1U << 14) - 1;  // bits; longer records are not kept

  // The budget must outlive the cache.
  explicit RecordCache(MemoryBudget& budget);
  ~RecordCache() override;

  // Copies the record; does nothing where it is known. The caller enforces the budget afterwards.
  void insert(const RecordEntry& entry, std::span<const uint8_t> source);
  [[nodiscard]] size_t bytes() const { return bytes_.load(); }

  class Reader {
   public:
    explicit Reader(RecordCache& cache) : cache_(cache) {}
    // What the record tells of the children; its bits are appended to `out`, which counts as a use,
    // unless that is null.
    [[nodiscard]] std::optional<ChildFacts> find(const NodeId& node, BitWriter* out);

   private:
    RecordCache& cache_;
    Shard* shard_ = nullptr;
    std::shared_lock<std::shared_mutex> lock_;
  };

 private:
  [[nodiscard]] Shard& shardOf(uint32_t tree) {
    return shards_[tree * 0x9E3779B1U >> 27];  // five bits: kShards
  }
  [[nodiscard]] static uint8_t* outsideBytes(const CachedRecord& record);
  static void release(Shard& shard, const CachedRecord& record);

  [[nodiscard]] size_t heldBytes() const override { return bytes_.load(); }
  [[nodiscard]] size_t unprovenBytes() const override;
  void release(size_t bytes) override;

  MemoryBudget& budget_;
  std::array<Shard, kShards> shards_;
  std::atomic<size_t> bytes_{0};
  std::atomic<size_t> entries_{0};
  std::atomic<size_t> proven_{0};  // of the entries, as of the last release
};

}  // namespace meshfront
