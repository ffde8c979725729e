#include "encoder/hierarchy/hilbert_curve.h"

#include <array>

namespace meshfront {

uint64_t hilbertIndex(const GridPosition& position) {
  constexpr unsigned kBits = kMaxQuantizationBits;
  std::array<uint32_t, 3> x{};
  for (size_t i = 0; i < 3; ++i) x[i] = static_cast<uint32_t>(position[i]);
  // Undo the excess work of Gray coding from the highest bit down (Skilling, AxesToTranspose).
  for (uint32_t q = 1U << (kBits - 1); q > 1; q >>= 1) {
    const uint32_t below = q - 1;
    for (auto& coordinate : x) {
      if ((coordinate & q) != 0) {
        x[0] ^= below;
      } else {
        const uint32_t swapped = (x[0] ^ coordinate) & below;
        x[0] ^= swapped;
        coordinate ^= swapped;
      }
    }
  }
  x[1] ^= x[0];
  x[2] ^= x[1];
  uint32_t flip = 0;
  for (uint32_t q = 1U << (kBits - 1); q > 1; q >>= 1)
    if ((x[2] & q) != 0) flip ^= q - 1;
  for (auto& coordinate : x) coordinate ^= flip;
  uint64_t index = 0;
  for (unsigned bit = kBits; bit-- > 0;)
    for (const uint32_t coordinate : x) index = index << 1 | (coordinate >> bit & 1);
  return index;
}

}  // namespace meshfront
