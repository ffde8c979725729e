// The place of a grid point along a three-dimensional Hilbert curve (Skilling 2004).
#pragma once

#include <cstdint>

#include "shared/mesh/quantization.h"

namespace meshfront {

// Coordinates below 2^20; the result below 2^60.
[[nodiscard]] uint64_t hilbertIndex(const GridPosition& position);

}  // namespace meshfront
