// The contexts of the cut code's decisions, numbered through: each has a chance of its own.
#pragma once

#include <array>
#include <cstdint>

#include "shared/codec/cut_frame.h"

namespace meshfront {

inline constexpr uint32_t kMaxRunsCoded = 6;  // of more runs all are taken as equally likely

namespace cut_contexts {
// Decision trees need as many contexts as symbols, rounded up to a power of two.
inline constexpr std::array<unsigned, 7> kCyclicTree{0, 0, 8, 16, 32, 32, 64};
inline constexpr std::array<unsigned, 7> kLinearTree{0, 0, 4, 8, 16, 16, 32};
// Two runs have places to look at.
[[nodiscard]] constexpr unsigned places(uint32_t runs) {
  return runs == 2 ? kPairPlaces : 1;
}

[[nodiscard]] constexpr unsigned beforeCyclic(uint32_t runs) {
  unsigned sum = 0;
  for (uint32_t i = 2; i < runs; ++i) sum += kCyclicTree[i] * places(i);
  return sum;
}
inline constexpr unsigned kLinearBegin = beforeCyclic(kMaxRunsCoded + 1);
[[nodiscard]] constexpr unsigned beforeLinear(uint32_t runs) {
  unsigned sum = kLinearBegin;
  for (uint32_t i = 2; i < runs; ++i) sum += 2 * kLinearTree[i] * places(i);
  return sum;
}
inline constexpr unsigned kStepBegin = beforeLinear(kMaxRunsCoded + 1);
}  // namespace cut_contexts

inline constexpr unsigned kCutContexts = cut_contexts::kStepBegin + kStepPlaces;
inline constexpr unsigned kEvenContext = kCutContexts;  // has no chance to be trained

// First context of a decision tree (its nodes count from 1).
[[nodiscard]] constexpr unsigned cyclicContexts(uint32_t runs, unsigned places) {
  return cut_contexts::beforeCyclic(runs) + places * cut_contexts::kCyclicTree[runs];
}
[[nodiscard]] constexpr unsigned linearContexts(uint32_t runs, bool leftFirst, unsigned places) {
  return cut_contexts::beforeLinear(runs) +
         (2 * places + (leftFirst ? 1U : 0U)) * cut_contexts::kLinearTree[runs];
}
[[nodiscard]] constexpr unsigned stepContext(unsigned places) {
  return cut_contexts::kStepBegin + places;
}

}  // namespace meshfront
