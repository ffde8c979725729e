// A set of slots that costs a few instructions to add to and is read back in ascending order, in
// time that grows with the set and not with the slots there are (but for one word in 262,144).
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "shared/refinement/growing_array.h"

namespace meshfront {

class SlotSet {
 public:
  // Slots from now on: 0 .. slots - 1. Never fewer than before.
  void resize(size_t slots) {
    if (slots <= words_.size() * 64) return;
    words_.resize(wordsFor(slots));
    summary_.resize(wordsFor(words_.size()));
    top_.resize(wordsFor(summary_.size()));
  }
  void add(uint32_t slot) {
    words_[slot >> 6] |= bit(slot);
    summary_[slot >> 12] |= bit(slot >> 6);
    top_[slot >> 18] |= bit(slot >> 12);
  }
  void remove(uint32_t slot) { words_[slot >> 6] &= ~bit(slot); }
  [[nodiscard]] bool has(uint32_t slot) const { return (words_[slot >> 6] & bit(slot)) != 0; }

  // Calls visit(slot) for all, ascending. The set must not change meanwhile.
  template <typename Visit>
  void forEach(const Visit& visit) const {
    for (size_t i = 0; i < top_.size(); ++i)
      forEachBit(top_[i], i, [&](size_t j) {
        forEachBit(summary_[j], j, [&](size_t k) {
          forEachBit(words_[k], k, [&](size_t slot) { visit(static_cast<uint32_t>(slot)); });
        });
      });
  }
  void clear() {
    for (size_t i = 0; i < top_.size(); ++i) {
      forEachBit(top_[i], i, [&](size_t j) {
        forEachBit(summary_[j], j, [&](size_t k) { words_[k] = 0; });
        summary_[j] = 0;
      });
      top_[i] = 0;
    }
  }
  // Bytes held, and those that would be held with so many slots.
  [[nodiscard]] size_t memoryBytes() const {
    return words_.memoryBytes() + summary_.memoryBytes() + top_.memoryBytes();
  }
  [[nodiscard]] size_t memoryBytesFor(size_t slots) const {
    const size_t words = wordsFor(slots);
    return words_.memoryBytesFor(words) + summary_.memoryBytesFor(wordsFor(words)) +
           top_.memoryBytesFor(wordsFor(wordsFor(words)));
  }

 private:
  [[nodiscard]] static size_t wordsFor(size_t bits) { return (bits + 63) / 64; }
  [[nodiscard]] static uint64_t bit(uint32_t at) { return uint64_t{1} << (at & 63); }
  template <typename Visit>
  static void forEachBit(uint64_t word, size_t at, const Visit& visit) {
    for (; word != 0; word &= word - 1)
      visit(at * 64 + static_cast<size_t>(std::countr_zero(word)));
  }

  GrowingArray<uint64_t> words_;
  GrowingArray<uint64_t> summary_;  // bit i: words_[i] may hold a bit
  GrowingArray<uint64_t> top_;      // bit i: summary_[i] may hold a bit
};

}  // namespace meshfront
