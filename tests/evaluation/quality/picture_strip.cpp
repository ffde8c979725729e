#include "tests/evaluation/quality/picture_strip.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace meshfront::evaluation {
namespace {

int largestDifference(const Picture& a, const Picture& b, size_t pixel) {
  int largest = 0;
  for (size_t channel = 0; channel < 3; ++channel)
    largest = std::max(largest,
                       std::abs(int{a.rgb[3 * pixel + channel]} - int{b.rgb[3 * pixel + channel]}));
  return largest;
}

}  // namespace

Picture pictureStrip(std::span<const Picture> pictures) {
  Picture strip;
  for (const Picture& picture : pictures) {
    strip.width += picture.width;
    strip.height = std::max(strip.height, picture.height);
  }
  strip.rgb.assign(size_t{3} * static_cast<size_t>(strip.width) * static_cast<size_t>(strip.height),
                   255);
  size_t left = 0;
  for (const Picture& picture : pictures) {
    const size_t bytes = size_t{3} * static_cast<size_t>(picture.width);
    for (size_t row = 0; row < static_cast<size_t>(picture.height); ++row)
      std::copy_n(picture.rgb.begin() + static_cast<ptrdiff_t>(row * bytes), bytes,
                  strip.rgb.begin() +
                      static_cast<ptrdiff_t>(3 * (row * static_cast<size_t>(strip.width) + left)));
    left += static_cast<size_t>(picture.width);
  }
  return strip;
}

PictureDifference differenceOf(const Picture& picture, const Picture& reference) {
  PictureDifference difference;
  difference.all = reference.rgb.size() / 3;
  for (size_t pixel = 0; pixel < difference.all; ++pixel) {
    const int largest = largestDifference(picture, reference, pixel);
    difference.pixels += largest > 0 ? 1 : 0;
    difference.clearPixels += largest > kClearDifference ? 1 : 0;
    const bool background = std::equal(reference.rgb.begin(), reference.rgb.begin() + 3,
                                       reference.rgb.begin() + static_cast<ptrdiff_t>(3 * pixel));
    difference.covered += background ? 0 : 1;
  }
  return difference;
}

Picture differencePicture(const Picture& picture, const Picture& reference) {
  Picture shown = reference;
  for (size_t pixel = 0; pixel < reference.rgb.size() / 3; ++pixel) {
    const double difference = largestDifference(picture, reference, pixel);
    const auto grey =
        static_cast<uint8_t>(255 - std::min(255.0, 255 * std::sqrt(difference / 128)));
    for (size_t channel = 0; channel < 3; ++channel) shown.rgb[3 * pixel + channel] = grey;
  }
  return shown;
}

}  // namespace meshfront::evaluation
