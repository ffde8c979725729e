#include "proxy/record_cache.h"

#include <algorithm>
#include <bit>

#include "shared/bits/bit_reader.h"

namespace meshfront {
namespace {

size_t byteCount(uint32_t bits) {
  return (bits + 7) / 8;
}

}  // namespace

RecordCache::RecordCache(MemoryBudget& budget) : budget_(budget) {
  budget_.join(this);
}

RecordCache::~RecordCache() {
  budget_.leave(this);
  for (Shard& shard : shards_)
    for (size_t i = 0; i < shard.table.places(); ++i)
      if (shard.table.place(i).path != 0) release(shard, shard.table.place(i).value);
}

uint8_t* RecordCache::outsideBytes(const CachedRecord& record) {
  return std::bit_cast<uint8_t*>(record.bits);
}

void RecordCache::release(Shard& shard, const CachedRecord& record) {
  if (record.isInline()) return;
  delete[] outsideBytes(record);
  shard.outside -= byteCount(record.length());
}

void RecordCache::insert(const RecordEntry& entry, std::span<const uint8_t> source) {
  if (entry.bitLength > kMaxLength) return;
  CachedRecord record;
  record.packed = entry.bitLength << 18 | (entry.leftIsLeaf ? 1U : 0U) << 17 |
                  (entry.rightIsLeaf ? 1U : 0U) << 16 | (entry.leftLevel & 31U) << 11 |
                  (entry.rightLevel & 31U) << 6;
  BitReader in(source, entry.bitOffset, entry.bitOffset + entry.bitLength);
  Shard& shard = shardOf(entry.id.tree);
  const std::unique_lock lock(shard.mutex);
  if (shard.table.find(entry.id) != nullptr) return;
  const size_t before = shard.bytes();
  if (record.isInline()) {
    const uint64_t high = in.peek(32) << 32;
    in.skip(entry.bitLength < 32 ? entry.bitLength : 32);
    const uint64_t low = in.peek(32);
    record.bits = {static_cast<uint32_t>(high >> 32), static_cast<uint32_t>(low)};
  } else {
    const size_t count = byteCount(entry.bitLength);
    auto* bytes = new uint8_t[count];
    for (size_t i = 0; i < count; ++i) {
      bytes[i] = static_cast<uint8_t>(in.peek(8));
      in.skip(in.left() < 8 ? in.left() : 8);
    }
    record.bits = std::bit_cast<std::array<uint32_t, 2>>(bytes);
    shard.outside += count;
  }
  shard.table.insert(entry.id, record);
  ++entries_;
  bytes_ += shard.bytes() - before;
}

std::optional<ChildFacts> RecordCache::Reader::find(const NodeId& node, BitWriter* out) {
  Shard& shard = cache_.shardOf(node.tree);
  if (&shard != shard_) {
    if (lock_.owns_lock()) lock_.unlock();
    shard_ = &shard;
    lock_ = std::shared_lock(shard.mutex);
  }
  CachedRecord* found = shard.table.find(node);
  if (found == nullptr) return std::nullopt;
  // Readers share the lock and set the mark, so that they meet that word atomically alone.
  const std::atomic_ref<uint32_t> packed(found->packed);
  const CachedRecord copy{packed.load(std::memory_order_relaxed), found->bits};
  const CachedRecord* record = &copy;
  if (out != nullptr) {
    const uint32_t use = record->nextUse();
    if (use != 0) packed.fetch_or(use, std::memory_order_relaxed);
    const uint32_t length = record->length();
    if (record->isInline()) {
      if (length > 32) {
        out->write(record->bits[0], 32);
        out->write(record->bits[1] >> (64 - length), length - 32);
      } else if (length > 0) {
        out->write(record->bits[0] >> (32 - length), length);
      }
    } else {
      out->append({outsideBytes(*record), byteCount(length)}, 0, length);
    }
  }
  return record->children();
}

size_t RecordCache::unprovenBytes() const {
  const size_t entries = entries_;
  if (entries == 0) return 0;
  const size_t unproven = entries - std::min(entries, proven_.load());
  return static_cast<size_t>(static_cast<double>(bytes_) * static_cast<double>(unproven) /
                             static_cast<double>(entries));
}

void RecordCache::release(size_t bytes) {
  const size_t total = bytes_;
  if (total == 0) return;
  for (Shard& shard : shards_) {  // each its part
    const std::unique_lock lock(shard.mutex);
    const size_t before = shard.bytes();
    const double part = std::min(1.0, static_cast<double>(bytes) / static_cast<double>(total));
    const size_t entries = shard.table.size();
    const size_t proven = shard.eviction.provenCount();
    const auto goal = static_cast<size_t>(static_cast<double>(before) * (1 - part));
    shard.eviction.evict(
        shard.table, [&] { return shard.bytes() <= goal; },
        [&](const CachedRecord& record) { release(shard, record); });
    bytes_ -= before - shard.bytes();
    entries_ -= entries - shard.table.size();
    proven_ += shard.eviction.provenCount() - proven;  // may wrap: the sum is right
  }
}

}  // namespace meshfront
