// The name of a vertex in the hierarchy: the tree it stands in and the path to it from the root.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>

namespace meshfront {

// Trees are at most this deep; the encoder makes no deeper one and decoders refuse deeper nodes.
inline constexpr unsigned kMaxDepth = 63;

struct NodeId {
  uint32_t tree = 0;
  uint8_t depth = 0;  // length of the path, 0 (root) .. kMaxDepth
  uint64_t path = 0;  // left-aligned: bit 63 is the first step, 0 = left, 1 = right; the rest is 0

  [[nodiscard]] static NodeId root(uint32_t tree) { return {tree, 0, 0}; }
  // Only below kMaxDepth.
  [[nodiscard]] NodeId child(bool right) const {
    const auto d = static_cast<uint8_t>(depth + 1);
    return {tree, d, path | static_cast<uint64_t>(right) << (63 - depth)};
  }
  // Only below the root.
  [[nodiscard]] NodeId parent() const {
    const auto d = static_cast<uint8_t>(depth - 1);
    return {tree, d, path & ~(uint64_t{1} << (63 - d))};
  }
  // The step taken at depth `at` (< depth): true = right.
  [[nodiscard]] bool step(unsigned at) const { return (path >> (63 - at) & 1) != 0; }
  // The ancestor at depth `at` (<= depth).
  [[nodiscard]] NodeId ancestor(unsigned at) const {
    return {tree, static_cast<uint8_t>(at), at == 0 ? 0 : path >> (64 - at) << (64 - at)};
  }
  // A node counts as its own ancestor.
  [[nodiscard]] bool isAncestorOf(const NodeId& other) const {
    return tree == other.tree && depth <= other.depth && other.ancestor(depth).path == path;
  }

  friend bool operator==(const NodeId&, const NodeId&) = default;
  // Preorder: by tree, then parents before children, left before right. The order of all wire
  // lists.
  friend std::strong_ordering operator<=>(const NodeId& a, const NodeId& b) {
    if (a.tree != b.tree) return a.tree <=> b.tree;
    if (a.path != b.path) return a.path <=> b.path;
    return a.depth <=> b.depth;
  }
};

struct NodeIdHash {
  size_t operator()(const NodeId& id) const {
    uint64_t h = (id.path ^ (uint64_t{id.tree} << 8 | id.depth)) * 0x9E3779B97F4A7C15ULL;
    h ^= h >> 32;
    h = (h ^ id.tree) * 0xD6E8FEB86659FD93ULL;
    return h ^ h >> 32;
  }
};

}  // namespace meshfront
