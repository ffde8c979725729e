// A flat hash table from NodeId to a small value: open addressing with linear probing, removal by
// shifting back (no tombstones), growing and shrinking between about 0.4 and 0.8 of its places.
// Not thread-safe. Value: trivially copyable.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "shared/hierarchy/node_id.h"

namespace meshfront {

template <typename Value>
class NodeTable {
 public:
  struct Slot {
    uint64_t path = 0;  // the path with a one behind its last step: never 0 for a node
    uint32_t tree = 0;
    Value value{};
  };

  // What an entry takes on average, unused places included.
  static constexpr size_t kBytesPerEntry = sizeof(Slot) * 8 / 5;

  [[nodiscard]] size_t size() const { return size_; }
  [[nodiscard]] size_t bytes() const { return size_ * kBytesPerEntry; }

  // Nullptr where there is none. Valid until the table changes.
  [[nodiscard]] const Value* find(const NodeId& node) const {
    if (slots_.empty()) return nullptr;
    const uint64_t path = pathKey(node);
    for (size_t i = home(path, node.tree);; i = next(i)) {
      const Slot& slot = slots_[i];
      if (slot.path == path && slot.tree == node.tree) return &slot.value;
      if (slot.path == 0) return nullptr;
    }
  }
  [[nodiscard]] Value* find(const NodeId& node) {
    return const_cast<Value*>(static_cast<const NodeTable*>(this)->find(node));
  }
  // Asks the processor to fetch the place of a node that find() is about to look for.
  void prefetch(const NodeId& node) const {
    if (!slots_.empty()) __builtin_prefetch(&slots_[home(pathKey(node), node.tree)]);
  }

  // False where the node has an entry already, which then stays as it is.
  bool insert(const NodeId& node, const Value& value) {
    if ((size_ + 1) * 5 > slots_.size() * 4) rehash(slots_.size() + slots_.size() / 2 + kLeast);
    const uint64_t path = pathKey(node);
    size_t i = home(path, node.tree);
    for (; slots_[i].path != 0; i = next(i))
      if (slots_[i].path == path && slots_[i].tree == node.tree) return false;
    slots_[i] = {path, node.tree, value};
    ++size_;
    return true;
  }

  bool erase(const NodeId& node) {
    const Value* value = find(node);
    if (value == nullptr) return false;
    const auto* slot =
        reinterpret_cast<const Slot*>(reinterpret_cast<const char*>(value) - offsetof(Slot, value));
    eraseAt(static_cast<size_t>(slot - slots_.data()));
    shrinkIfSparse();
    return true;
  }

  // For eviction by a hand that goes round: places 0 .. places() - 1, some of them empty (path 0).
  [[nodiscard]] size_t places() const { return slots_.size(); }
  [[nodiscard]] Slot& place(size_t i) { return slots_[i]; }
  // Another entry may move into the place.
  void eraseAt(size_t hole) {
    for (size_t i = next(hole); slots_[i].path != 0; i = next(i)) {
      // An entry may fill the hole unless its home lies behind the hole, up to where it is.
      const size_t h = home(slots_[i].path, slots_[i].tree);
      const bool homeBehindHole = hole <= i ? hole < h && h <= i : hole < h || h <= i;
      if (homeBehindHole) continue;
      slots_[hole] = slots_[i];
      hole = i;
    }
    slots_[hole] = Slot{};
    --size_;
  }
  void shrinkIfSparse() {
    if (slots_.size() > 4 * kLeast && size_ * 5 < slots_.size() * 2)
      rehash(size_ + size_ * 3 / 5 + kLeast);
  }

 private:
  static constexpr size_t kLeast = 16;

  [[nodiscard]] static uint64_t pathKey(const NodeId& node) {
    return node.path | uint64_t{1} << (63 - node.depth);
  }
  [[nodiscard]] size_t home(uint64_t path, uint32_t tree) const {
    uint64_t h = (path ^ path >> 32 ^ tree) * 0x9E3779B97F4A7C15ULL;
    h = (h ^ h >> 32 ^ uint64_t{tree} << 17) * 0xD6E8FEB86659FD93ULL;
    h ^= h >> 32;
    h *= 0x9E3779B97F4A7C15ULL;
    return static_cast<size_t>((h >> 32) * slots_.size() >> 32);  // tables stay below 2^32 places
  }
  [[nodiscard]] size_t next(size_t i) const { return i + 1 == slots_.size() ? 0 : i + 1; }

  void rehash(size_t places) {
    std::vector<Slot> old(places);
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.path == 0) continue;
      size_t i = home(slot.path, slot.tree);
      while (slots_[i].path != 0) i = next(i);
      slots_[i] = slot;
    }
  }

  std::vector<Slot> slots_;
  size_t size_ = 0;
};

}  // namespace meshfront
