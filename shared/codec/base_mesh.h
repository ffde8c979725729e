// The base resource: the coarsest mesh, the code tables, and what the roots need to be split.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/codec/code_tables.h"
#include "shared/mesh/indexed_mesh.h"
#include "shared/mesh/quantization.h"
#include "shared/result.h"

namespace meshfront {

struct BaseMesh {
  struct Root {
    GridPosition position{};
    bool isLeaf = false;  // then it has no record
    uint8_t level = 0;    // significance, 0 for a leaf
    VertexAttributes attributes;
  };
  unsigned quantizationBits = kDefaultQuantizationBits;
  uint64_t splitCount = 0;          // records of the whole mesh
  std::vector<Root> roots;          // tree-id = index
  uint32_t virtualCount = 0;        // trees roots.size() .. + virtualCount - 1: leaves without
                                    // position that close boundary loops; never drawn
  std::vector<Triangle> triangles;  // corners are tree-ids; a closed, oriented 2-manifold
  CodeTables tables;

  [[nodiscard]] uint32_t treeCount() const {
    return static_cast<uint32_t>(roots.size()) + virtualCount;
  }
};

// Versioned binary with a checksum; the layout is described in base_mesh.cpp.
[[nodiscard]] std::vector<uint8_t> encodeBaseMesh(const BaseMesh& base);
// Untrusted. Guarantees of the result: corners in range, every edge in exactly two triangles of
// opposite direction, levels <= tables.maxLevel.
[[nodiscard]] Result<BaseMesh> decodeBaseMesh(std::span<const uint8_t> bytes);

}  // namespace meshfront
