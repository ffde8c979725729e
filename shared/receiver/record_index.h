// Where the records of a revision lie in its segments: an open-addressed table of 16 octets a slot,
// because a large mesh has many millions of records. Nodes are told apart by a hash of 64 bits, and
// so whoever reads a record must see whether it is the node's.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "shared/hierarchy/node_id.h"

namespace meshfront {

struct CachedPlace {
  uint16_t segment = 0;
  uint16_t inBlock = 0;  // octets into the payload
  uint32_t block = 0;    // octets into the segment
  friend bool operator==(const CachedPlace&, const CachedPlace&) = default;
};

class RecordIndex {
 public:
  [[nodiscard]] std::optional<CachedPlace> find(const NodeId& id) const {
    if (slots_.empty()) return std::nullopt;
    const Slot& slot = slots_[slotOf(NodeIdHash()(id))];
    return slot.place == kFree || slot.place == kGone ? std::nullopt : std::optional(slot.place);
  }
  // Takes the place of what was known of the node.
  void set(const NodeId& id, CachedPlace place) {
    if (2 * (used_ + 1) > slots_.size()) grow();
    Slot& slot = slots_[slotOf(NodeIdHash()(id))];
    if (slot.place == kFree) {
      ++used_;
      ++count_;
    } else if (slot.place == kGone) {
      ++count_;
    }
    slot = {NodeIdHash()(id), place};
  }
  void erase(const NodeId& id) {
    if (!find(id)) return;
    slots_[slotOf(NodeIdHash()(id))].place = kGone;
    --count_;
  }
  [[nodiscard]] uint64_t count() const { return count_; }
  [[nodiscard]] size_t byteCount() const { return slots_.capacity() * sizeof(Slot); }

 private:
  // No segment has so many blocks.
  static constexpr CachedPlace kFree{UINT16_MAX, UINT16_MAX, UINT32_MAX};
  static constexpr CachedPlace kGone{UINT16_MAX, 0, UINT32_MAX};
  struct Slot {
    uint64_t key = 0;
    CachedPlace place = kFree;
  };

  // Of that key, or the free one where it belongs.
  [[nodiscard]] size_t slotOf(uint64_t key) const {
    size_t at = key & (slots_.size() - 1);
    while (slots_[at].place != kFree && slots_[at].key != key) at = (at + 1) & (slots_.size() - 1);
    return at;
  }
  void grow() {
    std::vector<Slot> old(slots_.empty() ? 1'024 : 2 * slots_.size());
    old.swap(slots_);
    used_ = 0;
    for (const Slot& slot : old) {
      if (slot.place == kFree || slot.place == kGone) continue;
      slots_[slotOf(slot.key)] = slot;
      ++used_;
    }
  }

  std::vector<Slot> slots_;  // a power of two
  uint64_t used_ = 0;        // gone ones too
  uint64_t count_ = 0;
};

}  // namespace meshfront
