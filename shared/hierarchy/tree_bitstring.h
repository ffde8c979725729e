// The wire form of a set of node IDs (Cheng and Ooi 2008, algorithm 1).
//
// A set is an antichain: no node in it is an ancestor of another (front vertices are one). Layout,
// bits most significant first:
//   number of trees            Exp-Golomb, order 3
//   for each tree, ascending:
//     tree-id - last - 1       Exp-Golomb, order 0 (the first tree: its id)
//     its root's visit         two bits a visited node, left then right, 1 = a wanted node lies
//     there;
//                              00 = this node is itself wanted; then the visits of the children
//   zero bits up to a whole byte
// There is exactly one encoding of a set; decoding refuses every other one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/bits/bit_reader.h"
#include "shared/bits/bit_writer.h"
#include "shared/hierarchy/node_id.h"
#include "shared/result.h"

namespace meshfront {

// `nodes` in preorder and an antichain (checked: an Error otherwise).
[[nodiscard]] Result<std::vector<uint8_t>> encodeTreeBitstring(std::span<const NodeId> nodes);
// The same into a larger stream, without the padding.
[[nodiscard]] Result<void> writeTreeBitstring(BitWriter& out, std::span<const NodeId> nodes);

// Untrusted. Nodes in preorder; ErrorCode::tooLarge beyond `maxNodes`, ErrorCode::invalid else.
[[nodiscard]] Result<std::vector<NodeId>> decodeTreeBitstring(std::span<const uint8_t> bytes,
                                                              size_t maxNodes);
// The same from a larger stream; leaves the reader behind the last visit.
[[nodiscard]] Result<std::vector<NodeId>> readTreeBitstring(BitReader& in, size_t maxNodes);

}  // namespace meshfront
