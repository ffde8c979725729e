// Reads the records of a node and of some descendants as they stand in chunks and answers:
// preorder, no framing. The one place that knows how IDs and levels of records below follow from
// those above.
#pragma once

#include <vector>

#include "shared/bits/bit_reader.h"
#include "shared/codec/chunk.h"
#include "shared/codec/record.h"

namespace meshfront {

// A node whose record is still to be read; readSubtree()'s working space.
struct PendingRecord {
  NodeId id;
  unsigned level = 0;
  unsigned generation = 0;
};

// Appends to `out` the entry of `top`, then of each descendant for which, like for all nodes
// between, `descend(generation, level)` holds (generation 1 = a child of top), until `out` holds
// `limit` entries. Leaves have no records. Untrusted: false where the bits are no records.
template <typename Descend>
bool readSubtree(BitReader& in, const CodeTables& tables, const NodeId& top, unsigned level,
                 const Descend& descend, uint64_t limit, std::vector<PendingRecord>& stack,
                 std::vector<RecordEntry>& out) {
  stack.clear();
  stack.push_back({top, level, 0});
  while (!stack.empty() && out.size() < limit) {
    const PendingRecord node = stack.back();
    stack.pop_back();
    const uint64_t begin = in.position();
    const Record record = readRecord(in, tables, node.level);
    if (in.overrun() || node.id.depth >= kMaxDepth) return false;
    out.push_back({node.id, static_cast<uint8_t>(node.level), record.leftIsLeaf, record.rightIsLeaf,
                   record.leftLevel, record.rightLevel, record.cutEnd, begin});
    const unsigned below = node.generation + 1;
    if (!record.rightIsLeaf && descend(below, record.rightLevel))
      stack.push_back({node.id.child(true), record.rightLevel, below});
    if (!record.leftIsLeaf && descend(below, record.leftLevel))
      stack.push_back({node.id.child(false), record.leftLevel, below});
  }
  return true;
}

}  // namespace meshfront
