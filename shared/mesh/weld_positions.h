// Finds the distinct positions among many: vertices at exactly equal coordinates become one.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace meshfront {

struct WeldedPositions {
  std::vector<std::array<double, 3>> positions;  // distinct, in order of first occurrence
  std::vector<uint32_t> indexOf;  // for each input position, its place in `positions`
};

// Equal means == in all three coordinates (so 0 and -0 are one). Fewer than 2^31 positions.
// Expected linear time; the result does not depend on how the table hashes.
[[nodiscard]] WeldedPositions weldPositions(std::span<const std::array<double, 3>> positions);

}  // namespace meshfront
