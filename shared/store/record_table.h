// Where the records of the chunks touched so far lie. Not thread-safe.
#pragma once

#include <cstdint>
#include <span>

#include "shared/codec/chunk.h"
#include "shared/store/node_table.h"
#include "shared/store/request_walk.h"

namespace meshfront {

struct RecordPlace {
  uint32_t chunk = 0;
  uint32_t bitOffset = 0;  // from the chunk's first bit
  uint32_t packed = 0;     // length in bits (20), leaf flags of u and t, their levels (5 each)

  [[nodiscard]] uint32_t bitLength() const { return packed >> 12; }
  [[nodiscard]] ChildFacts children() const {
    return {(packed >> 11 & 1) != 0, (packed >> 10 & 1) != 0,
            static_cast<uint8_t>(packed >> 5 & 31), static_cast<uint8_t>(packed & 31)};
  }
};

class RecordTable {
 public:
  // False, without adding anything, where a record lies beyond what a place can say (a chunk of
  // more than 512 MiB or a record of more than 2^20 bits: damaged).
  [[nodiscard]] bool addChunk(uint32_t number, std::span<const RecordEntry> entries);
  // The same entries as were added.
  void removeChunk(uint32_t number, std::span<const RecordEntry> entries);

  [[nodiscard]] const RecordPlace* find(const NodeId& node) const { return table_.find(node); }
  void prefetch(const NodeId& node) const { table_.prefetch(node); }
  [[nodiscard]] size_t bytes() const { return table_.bytes(); }

 private:
  NodeTable<RecordPlace> table_;
};

}  // namespace meshfront
