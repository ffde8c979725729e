// From a closed mesh and its vertex forest to the resources of the interface: base, chunks, index.
//
//   split_fields, cut_regions -> code tables -> records -> chunks
//
// Peak memory: about 194 bytes a vertex, input and forest included (scans of 0.1 to 1.4 million).
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
  uint64_t colours = 0;
  uint64_t normals = 0;
  uint64_t cutRegions = 0;  // what is in them and what pads them up to a length of the header
  uint64_t cutPadding = 0;  // the latter alone
  [[nodiscard]] uint64_t total() const {
    return header + significance + positionClasses + positionValues + colours + normals +
           cutRegions;
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
  AttributeLayout layout{};
  std::span<const VertexAttributes> attributes{};  // of real vertices; empty if the layout is
};

// Done so far and planned, in splits passed over; from the calling thread.
using CodingProgress = std::function<void(uint64_t done, uint64_t planned)>;

// `threads` changes the time, never the result.
[[nodiscard]] CodedMesh codeMesh(const CodingInput& input, const VertexForest& forest,
                                 unsigned threads, const CodingProgress& progress = {});

}  // namespace meshfront
