// Universal integer codes over bit streams.
//  - Exp-Golomb of order k (H.264 9.1 for k = 0): any value below 2^32.
//  - Truncated binary (phase-in) codes: a value below n in floor or ceil of log2(n) bits.
#pragma once

#include <bit>
#include <cstdint>

namespace meshfront {

template <typename Writer>
void writeExpGolomb(Writer& out, uint64_t value, unsigned order) {
  value += uint64_t{1} << order;
  const auto width = static_cast<unsigned>(std::bit_width(value));
  for (unsigned i = order + 1; i < width; ++i) out.write(0, 1);
  out.write(value, width);
}

// Fails the reader (sticky) when the prefix promises more than 40 bits.
template <typename Reader>
uint64_t readExpGolomb(Reader& in, unsigned order) {
  unsigned zeros = 0;
  while (!in.overrun() && !in.readBit()) {
    if (++zeros > 40) {
      in.fail();
      return 0;
    }
  }
  if (in.overrun()) return 0;
  const unsigned rest = zeros + order;
  const uint64_t value = (uint64_t{1} << rest) | in.read(rest);
  return value - (uint64_t{1} << order);
}

// `value` in 0..n-1, n >= 1.
template <typename Writer>
void writeTruncated(Writer& out, uint32_t value, uint32_t n) {
  const auto k = static_cast<unsigned>(std::bit_width(n) - 1);
  const uint32_t shortCodes = (uint32_t{2} << k) - n;  // that many values take k bits
  if (value < shortCodes) {
    out.write(value, k);
  } else {
    out.write(value + shortCodes, k + 1);
  }
}

template <typename Reader>
uint32_t readTruncated(Reader& in, uint32_t n) {
  const auto k = static_cast<unsigned>(std::bit_width(n) - 1);
  const uint32_t shortCodes = (uint32_t{2} << k) - n;
  const auto value = static_cast<uint32_t>(in.read(k));
  if (value < shortCodes) return value;
  return (value << 1 | static_cast<uint32_t>(in.readBit() ? 1 : 0)) - shortCodes;
}

}  // namespace meshfront
