// How a small signed integer is coded: its class, by a Huffman code, and the bits it leaves open.
// A class is the magnitude's bit length and second-highest bit: 0 for 0, 1 for 1, 2 for 2, 3 for 3,
// 4 for 4 and 5, 5 for 6 and 7, 6 for 8 to 11, ... (of magnitudes).
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>

#include "shared/bits/bit_writer.h"

namespace meshfront {

[[nodiscard]] inline unsigned valueClassOf(int32_t value) {
  const auto magnitude = static_cast<uint32_t>(std::abs(value));
  if (magnitude < 2) return magnitude;
  const auto length = static_cast<unsigned>(std::bit_width(magnitude));
  return 2 * (length - 1) + (magnitude >> (length - 2) & 1);
}

// Bits behind the sign that a class leaves open.
[[nodiscard]] inline unsigned openBits(unsigned valueClass) {
  return std::max(valueClass / 2, 1U) - 1;
}

// The bits that code a value besides its class: sign and open low bits.
[[nodiscard]] inline unsigned valueBits(int32_t value) {
  return value == 0 ? 0 : 1 + openBits(valueClassOf(value));
}

// Untrusted; valueClass < 2 * 25. Without branches, since nobody can guess values.
template <typename Reader>
int32_t readValue(Reader& in, unsigned valueClass) {
  const unsigned open = openBits(valueClass);
  const uint32_t lead = valueClass < 2 ? valueClass : 2U | (valueClass & 1U);
  const unsigned sign = valueClass == 0 ? 0 : 1;
  const auto bits = static_cast<uint32_t>(in.read(sign + open));
  const uint32_t magnitude = lead << open | (bits & ((1U << open) - 1));
  const uint32_t whenNegative = 0U - (bits >> open & sign);
  return static_cast<int32_t>((magnitude ^ whenNegative) - whenNegative);
}

inline void writeValue(BitWriter& out, int32_t value) {
  if (value == 0) return;
  out.writeBit(value < 0);
  out.write(static_cast<uint32_t>(std::abs(value)), openBits(valueClassOf(value)));
}

}  // namespace meshfront
