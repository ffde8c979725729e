// What the record indexes of all packs of a service count together.
#pragma once

#include <atomic>
#include <cstdint>

namespace meshfront {

struct IndexStatistics {
  std::atomic<uint64_t> hits{0};             // records of answers that were found indexed
  std::atomic<uint64_t> misses{0};           // records that were looked for in their chunk
  std::atomic<uint64_t> chunksIndexed{0};    // decoded, at the first touch or again
  std::atomic<uint64_t> chunksForgotten{0};  // to keep within the budget
};

}  // namespace meshfront
