#include "shared/hierarchy/tree_bitstring.h"

#include <array>

#include "shared/bits/integer_codes.h"

namespace meshfront {
namespace {

constexpr unsigned kTreeCountOrder = 3;
constexpr unsigned kTreeGapOrder = 0;

// Writes the visits of nodes that share a tree. An explicit stack of sub-ranges, one per pending
// visit, keeps the depth of the call stack independent of the input.
void writeTree(BitWriter& out, std::span<const NodeId> nodes) {
  struct Range {
    size_t begin, end;
    unsigned depth;
  };
  std::vector<Range> stack{{0, nodes.size(), 0}};
  while (!stack.empty()) {
    const Range range = stack.back();
    stack.pop_back();
    if (nodes[range.begin].depth == range.depth) {  // wanted itself; an antichain: nothing below
      out.write(0, 2);
      continue;
    }
    size_t middle = range.begin;
    while (middle < range.end && !nodes[middle].step(range.depth)) ++middle;
    const bool left = middle > range.begin;
    const bool right = middle < range.end;
    out.write((left ? 2U : 0U) | (right ? 1U : 0U), 2);
    if (right) stack.push_back({middle, range.end, range.depth + 1});
    if (left) stack.push_back({range.begin, middle, range.depth + 1});
  }
}

// Appends the wanted nodes of one tree to the first `count` of `nodes`, which may be longer than
// that. Visits come 28 at a time and without branches on their bits, which cannot be predicted.
Result<void> readTree(BitReader& in, uint32_t tree, size_t maxNodes, std::vector<NodeId>& nodes,
                      size_t& count) {
  constexpr unsigned kVisits = 28;
  struct Place {
    uint64_t path;
    unsigned depth;
  };
  // A right sibling for each depth, the node itself, room to spare.
  std::array<Place, kMaxDepth + 3> stack{};
  unsigned pending = 1;
  while (pending > 0) {
    uint64_t bits = in.peek(2 * kVisits) << (64 - 2 * kVisits);
    if (nodes.size() < count + kVisits) nodes.resize(2 * nodes.size() + kVisits);
    unsigned visits = 0;
    for (; visits < kVisits && pending > 0; ++visits) {
      const Place at = stack[--pending];
      const auto visit = static_cast<unsigned>(bits >> 62);
      bits <<= 2;
      nodes[count] = {tree, static_cast<uint8_t>(at.depth), at.path};
      count += visit == 0 ? 1 : 0;
      if (at.depth >= kMaxDepth && visit != 0) return fail("node set: a path deeper than any tree");
      stack[pending] = {at.path | uint64_t{1} << (63 - at.depth), at.depth + 1};
      pending += visit & 1;
      stack[pending] = {at.path, at.depth + 1};
      pending += visit >> 1;
    }
    in.skip(2 * visits);
    if (in.overrun()) return fail("node set: the bitstring ends early");
    if (count > maxNodes)
      return fail(ErrorCode::tooLarge,
                  "node set: more than " + std::to_string(maxNodes) + " nodes; ask for fewer");
  }
  return {};
}

}  // namespace

Result<void> writeTreeBitstring(BitWriter& out, std::span<const NodeId> nodes) {
  uint64_t trees = 0;
  for (size_t i = 0; i < nodes.size(); ++i) {
    if (i == 0 || nodes[i].tree != nodes[i - 1].tree) ++trees;
    if (i > 0 && (nodes[i] <= nodes[i - 1] || nodes[i - 1].isAncestorOf(nodes[i])))
      return fail("node set: not sorted in preorder, repeated, or a node above another");
  }
  writeExpGolomb(out, trees, kTreeCountOrder);
  uint64_t next = 0;
  for (size_t i = 0; i < nodes.size();) {
    size_t end = i;
    while (end < nodes.size() && nodes[end].tree == nodes[i].tree) ++end;
    writeExpGolomb(out, nodes[i].tree - next, kTreeGapOrder);
    next = uint64_t{nodes[i].tree} + 1;
    writeTree(out, nodes.subspan(i, end - i));
    i = end;
  }
  return {};
}

Result<std::vector<uint8_t>> encodeTreeBitstring(std::span<const NodeId> nodes) {
  BitWriter out;
  if (auto written = writeTreeBitstring(out, nodes); !written)
    return tl::unexpected(written.error());
  return out.take();
}

Result<std::vector<NodeId>> readTreeBitstring(BitReader& in, size_t maxNodes) {
  std::vector<NodeId> nodes;
  size_t count = 0;
  const uint64_t trees = readExpGolomb(in, kTreeCountOrder);
  uint64_t next = 0;
  for (uint64_t t = 0; t < trees; ++t) {
    const uint64_t tree = next + readExpGolomb(in, kTreeGapOrder);
    if (tree > UINT32_MAX) return fail("node set: a tree number beyond 32 bits");
    next = tree + 1;
    if (auto read = readTree(in, static_cast<uint32_t>(tree), maxNodes, nodes, count); !read)
      return tl::unexpected(read.error());
  }
  if (in.overrun()) return fail("node set: the bitstring ends early");
  nodes.resize(count);
  return nodes;
}

Result<std::vector<NodeId>> decodeTreeBitstring(std::span<const uint8_t> bytes, size_t maxNodes) {
  BitReader in(bytes);
  auto nodes = readTreeBitstring(in, maxNodes);
  if (!nodes) return nodes;
  const uint64_t spare = in.left();
  if (spare >= 8 || in.read(static_cast<unsigned>(spare)) != 0)
    return fail("node set: bits behind the last node");
  return nodes;
}

}  // namespace meshfront
