// One node's record, taken apart at the coarsest front at which the node can be split: its
// ancestors are split and nothing else.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/codec/position_prediction.h"
#include "shared/codec/record.h"
#include "shared/hierarchy/node_id.h"
#include "shared/mesh/quantization.h"
#include "shared/mesh/vertex_attributes.h"
#include "shared/result.h"
#include "shared/store/pack.h"

namespace meshfront {

struct NodeRecord {
  // Where it is.
  NodeId id;
  unsigned level = 0;
  uint32_t chunk = 0;      // its number
  uint64_t bitOffset = 0;  // in the chunk's bytes
  uint32_t bitLength = 0;
  std::string bits;  // of 0 and 1

  // What it says. Lengths in bits, in the order of the fields.
  Record record;
  unsigned cutClass = 0;
  uint32_t headerBits = 0;
  uint32_t levelBits = 0;
  uint32_t classBits = 0;
  uint32_t valueBits = 0;
  uint32_t colourBits = 0;
  uint32_t normalBits = 0;
  std::string cutRegion;  // of 0 and 1

  // What follows from it here.
  PredictedNormal normal{};  // of the node
  unsigned mainAxis = 0;     // of the normal; d_a is along it
  GridPosition position{};   // of the node, and of u
  GridPosition delta{};      // d
  AttributeLayout layout;
  VertexAttributes attributes;       // of the node, and of u
  VertexAttributes rightAttributes;  // of t

  // The cut at this front.
  struct RingEntry {
    NodeId node;
    bool isVirtual = false;
  };
  std::vector<RingEntry> ring;
  uint32_t leftEntry = 0;  // l
  uint32_t rightEntry = 0;
  bool leftFirst = true;  // of meaning where both are one entry
  struct Decision {
    const char* about = "";  // what is decided
    unsigned context = 0;
    unsigned chanceOfZero = 0;  // in 64
    bool backward = false;
    bool bit = false;
  };
  std::vector<Decision> decisions;
};

// Errors: notFound (no such node, a leaf, a virtual vertex), invalid (a damaged pack).
[[nodiscard]] Result<NodeRecord> nodeRecord(const Pack& pack, const NodeId& id);

}  // namespace meshfront
