#include "shared/receiver/held_chunks.h"

#include <algorithm>
#include <utility>

namespace meshfront {

void HeldChunks::hold(uint32_t chunk, std::vector<uint8_t> bytes,
                      std::span<const RecordEntry> entries) {
  Held& held = chunks_[chunk];
  held.held = true;
  held.unapplied = static_cast<uint32_t>(entries.size());
  held.bytes = std::move(bytes);
  held.bytes.shrink_to_fit();
  held.records.clear();
  held.records.reserve(entries.size());
  for (const RecordEntry& entry : entries)
    held.records.push_back({entry.id, static_cast<uint32_t>(entry.bitOffset), entry.bitLength});
}

std::optional<HeldRecord> HeldChunks::find(uint32_t chunk, const NodeId& id) const {
  const std::vector<HeldRecord>& records = chunks_[chunk].records;
  const auto found = std::lower_bound(
      records.begin(), records.end(), id,
      [](const HeldRecord& record, const NodeId& node) { return record.id < node; });
  if (found == records.end() || found->id != id) return std::nullopt;
  return *found;
}

void HeldChunks::countApplied(uint32_t chunk) {
  Held& held = chunks_[chunk];
  if (held.unapplied == 0 || --held.unapplied > 0) return;
  held.bytes = {};
  held.records = {};
}

}  // namespace meshfront
