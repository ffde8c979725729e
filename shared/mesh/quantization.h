// One grid per mesh: a cube around the input with 2^bits - 1 steps a side. Integers on it are what
// the codec carries and what "exact" means; doubles exist only at both ends.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace meshfront {

using GridPosition = std::array<int32_t, 3>;  // each 0 .. 2^bits - 1

inline constexpr unsigned kMinQuantizationBits = 8;
inline constexpr unsigned kMaxQuantizationBits = 20;
inline constexpr unsigned kDefaultQuantizationBits = 14;

struct Quantization {
  unsigned bits = kDefaultQuantizationBits;
  std::array<double, 3> origin{};  // world position of grid point (0, 0, 0)
  double step = 1;                 // world length of one grid step, > 0

  [[nodiscard]] int32_t maximum() const { return static_cast<int32_t>((1U << bits) - 1); }
  [[nodiscard]] GridPosition toGrid(const std::array<double, 3>& world) const {
    GridPosition grid{};
    for (size_t i = 0; i < 3; ++i) {
      const double steps = std::floor((world[i] - origin[i]) / step + 0.5);
      grid[i] = static_cast<int32_t>(std::fmin(std::fmax(steps, 0), maximum()));
    }
    return grid;
  }
  [[nodiscard]] std::array<double, 3> toWorld(const GridPosition& grid) const {
    return {origin[0] + step * grid[0], origin[1] + step * grid[1], origin[2] + step * grid[2]};
  }
};

// The grid of the cube that starts at the box's lower corner and is as long as its longest side.
// A mesh that is a single point gets step 1.
[[nodiscard]] Quantization quantizationFor(std::span<const std::array<double, 3>> positions,
                                           unsigned bits);

}  // namespace meshfront
