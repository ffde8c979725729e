// Cut decisions of all splits, two bytes each, between the pass that counts them and the one that
// writes them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/codec/cut_coding.h"

namespace meshfront {

class CutArchive {
 public:
  void append(std::span<const CutDecision> cut) {
    for (const auto& decision : cut)
      words_.push_back(static_cast<uint16_t>(decision.context << 3 | (decision.backward ? 2U : 0U) |
                                             (decision.bit ? 1U : 0U)));
    // Every cut has a decision: a ring has two runs or more.
    words_.back() |= kLast;
  }
  // Reads the cuts back in the order appended; `position` starts at 0.
  void read(size_t& position, std::vector<CutDecision>& out) const {
    out.clear();
    for (;;) {
      const uint16_t word = words_[position++];
      out.push_back({static_cast<uint16_t>(word >> 3), (word & 1) != 0, (word & 2) != 0});
      if ((word & kLast) != 0) return;
    }
  }

 private:
  static constexpr uint16_t kLast = 4;
  static_assert(kCutContexts < 1U << 13);
  std::vector<uint16_t> words_;
};

}  // namespace meshfront
