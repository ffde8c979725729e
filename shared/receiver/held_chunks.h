// The chunks that have arrived, until each of their records has been applied.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/codec/chunk.h"
#include "shared/hierarchy/node_id.h"

namespace meshfront {

// A record of a held chunk: bits of bytesOf(chunk).
struct HeldRecord {
  NodeId id{};
  uint32_t bitOffset = 0;
  uint32_t bitLength = 0;
};

class HeldChunks {
 public:
  explicit HeldChunks(uint32_t chunkCount) : chunks_(chunkCount) {}

  // Was held and not forgotten, although it may have been used up since.
  [[nodiscard]] bool has(uint32_t chunk) const { return chunks_[chunk].held; }
  // Held, and none of its records is left.
  [[nodiscard]] bool isUsedUp(uint32_t chunk) const {
    return chunks_[chunk].held && chunks_[chunk].records.empty();
  }
  // `entries`: preorder, offsets into `bytes`, as decodeChunk() gives them.
  void hold(uint32_t chunk, std::vector<uint8_t> bytes, std::span<const RecordEntry> entries);
  void forget(uint32_t chunk) { chunks_[chunk] = {}; }

  // Preorder; empty where the chunk is not held or used up.
  [[nodiscard]] std::span<const HeldRecord> recordsOf(uint32_t chunk) const {
    return chunks_[chunk].records;
  }
  [[nodiscard]] std::optional<HeldRecord> find(uint32_t chunk, const NodeId& id) const;
  [[nodiscard]] std::span<const uint8_t> bytesOf(uint32_t chunk) const {
    return chunks_[chunk].bytes;
  }
  // One of its records, each only once. After the last one the chunk's memory is freed.
  void countApplied(uint32_t chunk);

 private:
  struct Held {
    bool held = false;
    uint32_t unapplied = 0;
    std::vector<uint8_t> bytes;
    std::vector<HeldRecord> records;
  };
  std::vector<Held> chunks_;  // by number
};

}  // namespace meshfront
