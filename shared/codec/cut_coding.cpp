#include "shared/codec/cut_coding.h"

#include "shared/bits/fixed_logarithm.h"

namespace meshfront {

void CutStatistics::add(std::span<const CutDecision> cut) {
  for (const auto& decision : cut) ++counts[decision.context][decision.bit ? 1 : 0];
}

void CutStatistics::add(const CutStatistics& other) {
  for (size_t i = 0; i < counts.size(); ++i)
    for (size_t bit = 0; bit < 2; ++bit) counts[i][bit] += other.counts[i][bit];
}

CutChances CutStatistics::chances() const {
  CutChances chances{};
  // In 65536ths of a bit.
  const auto bitsWith = [](const std::array<uint64_t, 2>& n, unsigned chance) {
    constexpr uint64_t kWhole = uint64_t{kChanceBits} << kFixedBits;
    return n[0] * (kWhole - fixedLog2(chance)) +
           n[1] * (kWhole - fixedLog2((1U << kChanceBits) - chance));
  };
  constexpr unsigned kLargest = (1U << kChanceBits) - 1;
  unsigned last = kEvenChance;
  for (unsigned i = 0; i < kCutContexts; ++i) {
    // Tables tell differences from the chance before; a zero is much cheaper than others.
    constexpr uint64_t kDifferenceBits = uint64_t{6} << kFixedBits;
    unsigned best = last;
    uint64_t least = bitsWith(counts[i], last);
    for (unsigned chance = 1; chance <= kLargest; ++chance) {
      const uint64_t bits = bitsWith(counts[i], chance) + kDifferenceBits;
      if (bits < least) {
        least = bits;
        best = chance;
      }
    }
    chances[i] = static_cast<uint8_t>(best);
    last = best;
  }
  chances[kEvenContext] = kEvenChance;
  return chances;
}

void writeCut(TwoEndedWriter& out, std::span<const CutDecision> cut, const CutChances& chances) {
  out.clear();
  for (const auto& decision : cut)
    (decision.backward ? out.backward() : out.forward())
        .encode(decision.bit, chances[decision.context]);
}

}  // namespace meshfront
