// From a closed mesh and its vertex forest to the resources of the interface: base, chunks, index.
//
//   static rings -> cut symbols -> code tables -> records -> chunks
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "encoder/hierarchy/vertex_forest.h"
#include "shared/codec/base_mesh.h"
#include "shared/codec/chunk.h"

namespace meshfront {

// Where the bits of all records go. Sums over the mesh.
struct FieldBits {
  uint64_t splits = 0;
  uint64_t header = 0;           // leaf flags and class of the cut region's length, one symbol
  double leafFlags = 0;          // the part of `header` that leaf flags alone would take (entropy)
  uint64_t significance = 0;     // levels
  uint64_t positionClasses = 0;  // bit lengths of d_b, d_c and the residual
  uint64_t positionValues = 0;   // signs and mantissas
  uint64_t cutCode = 0;          // used bits of the cut regions
  uint64_t cutPadding = 0;       // unused ones
  [[nodiscard]] uint64_t total() const {
    return header + significance + positionClasses + positionValues + cutCode + cutPadding;
  }
};

struct CodedMesh {
  std::vector<uint8_t> base;
  std::vector<uint8_t> chunkIndex;
  std::vector<std::vector<uint8_t>> chunks;
  FieldBits bits;
  uint64_t tableBits = 0;      // of the code tables, in the base
  uint32_t baseTriangles = 0;  // drawn ones
};

struct CodingInput {
  std::span<const GridPosition> positions;  // real vertices
  uint32_t virtualCount = 0;
  std::span<const Triangle> triangles;  // closed
  unsigned quantizationBits = kDefaultQuantizationBits;
};

// Done so far and planned, in splits passed over; from the calling thread.
using CodingProgress = std::function<void(uint64_t done, uint64_t planned)>;

// `threads` changes the time, never the result.
[[nodiscard]] CodedMesh codeMesh(const CodingInput& input, const VertexForest& forest,
                                 unsigned threads, const CodingProgress& progress = {});

}  // namespace meshfront
