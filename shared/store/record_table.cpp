#include "shared/store/record_table.h"

namespace meshfront {

bool RecordTable::addChunk(uint32_t number, std::span<const RecordEntry> entries) {
  constexpr uint32_t kMaxLength = 1U << 20;
  for (const RecordEntry& entry : entries)
    if (entry.bitOffset > UINT32_MAX || entry.bitLength >= kMaxLength) return false;
  for (const RecordEntry& entry : entries) {
    const uint32_t packed = entry.bitLength << 12 | (entry.leftIsLeaf ? 1U : 0U) << 11 |
                            (entry.rightIsLeaf ? 1U : 0U) << 10 |
                            (uint32_t{entry.leftLevel} & 31U) << 5 | (entry.rightLevel & 31U);
    table_.insert(entry.id, {number, static_cast<uint32_t>(entry.bitOffset), packed});
  }
  return true;
}

void RecordTable::removeChunk(uint32_t number, std::span<const RecordEntry> entries) {
  for (const RecordEntry& entry : entries) {
    const RecordPlace* place = table_.find(entry.id);
    // A damaged pack may hold a node twice; only the chunk that was added first owns the entry.
    if (place != nullptr && place->chunk == number) table_.erase(entry.id);
  }
}

}  // namespace meshfront
