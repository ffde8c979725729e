// Vertices in an order in which neighbours in space mostly stand close together in memory: cells
// along a Morton curve. Simplification waits for memory more than for arithmetic.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/mesh/quantization.h"

namespace meshfront {

// The positions' indices along the curve, the same on every machine; within a cell by index. There
// are 1024 cells along the longest side of the bounding box.
[[nodiscard]] std::vector<uint32_t> spaceFillingOrder(std::span<const GridPosition> positions);

}  // namespace meshfront
