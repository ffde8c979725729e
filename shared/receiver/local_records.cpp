#include "shared/receiver/local_records.h"

#include "shared/receiver/disk_cache.h"

namespace meshfront {

bool LocalRecords::has(NodeIndex node) const {
  return to_.mesh.hasRecord(node) || (to_.cache != nullptr && to_.cache->has(to_.mesh.id(node)));
}

bool LocalRecords::split(NodeIndex node) {
  if (to_.mesh.hasRecord(node)) {
    if (to_.mesh.resplit(node)) return true;
    // It was kept unseen, and is no good.
    ++to_.statistics.malformed;
    (void)to_.mesh.dropRecord(node);
  }
  if (to_.cache == nullptr) return false;
  const NodeId id = to_.mesh.id(node);
  const std::optional<DiskRecord> record = to_.cache->find(id);
  if (!record) return false;
  if (!to_.mesh.split(node, record->bytes, record->bitOffset, record->bitLength)) {
    to_.cache->forget(id);
    return false;
  }
  ++to_.statistics.records;
  ++to_.statistics.recordsFromDisk;
  return true;
}

void LocalRecords::keep(const NodeId& node, std::span<const uint8_t> bytes, uint64_t bitOffset,
                        uint32_t bitLength) {
  if (to_.cache != nullptr) to_.cache->keep(node, bytes, bitOffset, bitLength);
}

}  // namespace meshfront
