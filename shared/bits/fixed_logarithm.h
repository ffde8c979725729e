// Logarithms that are the same on every machine, for costs that decide what is written.
#pragma once

#include <bit>
#include <cstdint>

namespace meshfront {

inline constexpr unsigned kFixedBits = 16;

// log2(value) in 65536ths, rounded down; value > 0.
[[nodiscard]] constexpr uint64_t fixedLog2(uint64_t value) {
  const auto whole = static_cast<unsigned>(std::bit_width(value) - 1);
  // The mantissa, 1 <= m < 2, with 31 bits behind the point; squaring doubles its logarithm.
  uint64_t mantissa = whole > 31 ? value >> (whole - 31) : value << (31 - whole);
  uint64_t fraction = 0;
  for (unsigned i = 0; i < kFixedBits; ++i) {
    mantissa = mantissa * mantissa >> 31;
    fraction <<= 1;
    if (mantissa >> 32 != 0) {
      mantissa >>= 1;
      ++fraction;
    }
  }
  return uint64_t{whole} << kFixedBits | fraction;
}

}  // namespace meshfront
