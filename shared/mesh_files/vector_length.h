// The Euclidean length of a vector, by correctly rounded operations alone: what std::hypot gives
// differs between C libraries, and what is read must be the same on every machine.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace meshfront {

// No overflow in between; NaN if a component is NaN or infinite.
template <size_t N>
[[nodiscard]] double lengthOf(const std::array<double, N>& vector) {
  double largest = 0;
  for (const double component : vector) largest = std::max(largest, std::abs(component));
  double sum = 0;
  for (const double component : vector) {
    const double scaled = largest > 0 ? component / largest : component;
    sum += scaled * scaled;
  }
  return largest * std::sqrt(sum);
}

}  // namespace meshfront
