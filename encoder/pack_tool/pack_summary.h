// What can be counted in a pack beside its metadata and the encoder's report.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/mesh/vertex_attributes.h"
#include "shared/result.h"
#include "shared/store/pack.h"

namespace meshfront {

struct Sizes {
  uint64_t count = 0;
  uint64_t bytes = 0;  // of all
  uint64_t least = 0;  // 0 where there are none, likewise the following
  uint64_t median = 0;
  uint64_t most = 0;
};
// Reorders `sizes`.
[[nodiscard]] Sizes summarise(std::vector<uint64_t>& sizes);

struct PackSummary {
  uint32_t roots = 0;  // trees with a position
  uint32_t virtualTrees = 0;
  AttributeLayout layout;
  // Of the base: code tables; triangles; what begins and ends it (magic number, checksum); roots,
  // with the counts and the padding.
  uint64_t baseTableBits = 0;
  uint64_t baseRootBits = 0;
  uint64_t baseTriangleBits = 0;
  uint64_t baseOtherBits = 0;
  Sizes chunks;
  std::vector<Sizes> chunksByBand;
  unsigned treeNumberBits = 0;  // that tell all trees apart
};

// Reads the size of every chunk. An Error if base or index are damaged or a chunk is missing.
[[nodiscard]] Result<PackSummary> summarise(const Pack& pack);

}  // namespace meshfront
