#include "shared/hierarchy/tree_bitstring.h"

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
  std::vector<NodeId> stack;
  const uint64_t trees = readExpGolomb(in, kTreeCountOrder);
  uint64_t next = 0;
  for (uint64_t t = 0; t < trees; ++t) {
    const uint64_t tree = next + readExpGolomb(in, kTreeGapOrder);
    if (tree > UINT32_MAX) return fail("node set: a tree number beyond 32 bits");
    next = tree + 1;
    stack.push_back(NodeId::root(static_cast<uint32_t>(tree)));
    while (!stack.empty()) {
      const NodeId node = stack.back();
      stack.pop_back();
      const uint64_t visit = in.read(2);
      if (in.overrun()) return fail("node set: the bitstring ends early");
      if (visit == 0) {
        if (nodes.size() >= maxNodes)
          return fail(ErrorCode::tooLarge,
                      "node set: more than " + std::to_string(maxNodes) + " nodes; ask for fewer");
        nodes.push_back(node);
        continue;
      }
      if (node.depth >= kMaxDepth) return fail("node set: a path deeper than any tree");
      if ((visit & 1) != 0) stack.push_back(node.child(true));
      if ((visit & 2) != 0) stack.push_back(node.child(false));
    }
  }
  if (in.overrun()) return fail("node set: the bitstring ends early");
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
