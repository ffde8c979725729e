// Pictures side by side, and where two pictures differ.
#pragma once

#include <cstdint>
#include <span>

#include "viewer/picture/picture.h"

namespace meshfront::evaluation {

// From left to right, of equal heights. Empty ones are left out.
[[nodiscard]] Picture pictureStrip(std::span<const Picture> pictures);

struct PictureDifference {
  uint64_t pixels = 0;       // that differ in any channel
  uint64_t clearPixels = 0;  // that differ by more than kClearDifference in some channel
  uint64_t covered = 0;      // pixels of the reference that are no background
  uint64_t all = 0;
};
inline constexpr int kClearDifference = 8;  // of 255: about what is seen

// Of equal sizes. The reference's first pixel counts as background.
[[nodiscard]] PictureDifference differenceOf(const Picture& picture, const Picture& reference);

// White where equal, the darker the more it differs.
[[nodiscard]] Picture differencePicture(const Picture& picture, const Picture& reference);

}  // namespace meshfront::evaluation
