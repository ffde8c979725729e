#include "encoder/simplification/space_filling_order.h"

#include <algorithm>
#include <array>

namespace meshfront {

namespace {

constexpr unsigned kBitsPerAxis = 10;
constexpr unsigned kDigitBits = 10;  // three passes of a radix sort

// Bits 0 .. 9 moved to every third place.
uint32_t spread(uint32_t x) {
  x = (x | x << 16) & 0x030000FFU;
  x = (x | x << 8) & 0x0300F00FU;
  x = (x | x << 4) & 0x030C30C3U;
  return (x | x << 2) & 0x09249249U;
}

}  // namespace

std::vector<uint32_t> spaceFillingOrder(std::span<const GridPosition> positions) {
  if (positions.empty()) return {};
  GridPosition low = positions[0];
  GridPosition high = positions[0];
  for (const GridPosition& p : positions) {
    for (size_t i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], p[i]);
      high[i] = std::max(high[i], p[i]);
    }
  }
  uint32_t longest = 0;
  for (size_t i = 0; i < 3; ++i) {
    longest = std::max(longest, static_cast<uint32_t>(high[i]) - static_cast<uint32_t>(low[i]));
  }
  unsigned shift = 0;
  while (longest >> shift >= 1U << kBitsPerAxis) ++shift;

  struct Cell {
    uint32_t code;
    uint32_t vertex;
  };
  std::vector<Cell> cells(positions.size());
  std::vector<Cell> sorted(positions.size());
  for (uint32_t v = 0; v < positions.size(); ++v) {
    uint32_t code = 0;
    for (unsigned i = 0; i < 3; ++i) {
      const uint32_t offset =
          static_cast<uint32_t>(positions[v][i]) - static_cast<uint32_t>(low[i]);
      code |= spread(offset >> shift) << i;
    }
    cells[v] = {code, v};
  }
  for (unsigned digit = 0; digit < 3 * kBitsPerAxis; digit += kDigitBits) {
    const auto digitOf = [digit](const Cell& c) {
      return c.code >> digit & ((1U << kDigitBits) - 1);
    };
    std::array<uint32_t, (1U << kDigitBits) + 1> start{};
    for (const Cell& c : cells) ++start[digitOf(c) + 1];
    for (size_t d = 1; d < start.size(); ++d) start[d] += start[d - 1];
    for (const Cell& c : cells) sorted[start[digitOf(c)]++] = c;
    cells.swap(sorted);
  }
  std::vector<uint32_t> order(positions.size());
  std::transform(cells.begin(), cells.end(), order.begin(), [](const Cell& c) { return c.vertex; });
  return order;
}

}  // namespace meshfront
