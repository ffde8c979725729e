#include "shared/mesh/quantization.h"

#include <algorithm>

namespace meshfront {

Quantization quantizationFor(std::span<const std::array<double, 3>> positions, unsigned bits) {
  Quantization q;
  q.bits = bits;
  if (positions.empty()) return q;
  std::array<double, 3> low = positions[0];
  std::array<double, 3> high = positions[0];
  for (const auto& p : positions) {
    for (size_t i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], p[i]);
      high[i] = std::max(high[i], p[i]);
    }
  }
  const double side = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  q.origin = low;
  const double step = side / q.maximum();
  if (step > 0) q.step = step;
  return q;
}

}  // namespace meshfront
