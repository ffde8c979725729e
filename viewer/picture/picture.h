// A picture in memory, as a PNG file, and its distance from another one. No GL here.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "shared/result.h"

namespace meshfront {

struct Picture {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> rgb;  // 3 bytes a pixel, rows from the top, no padding

  bool operator==(const Picture&) const = default;
};

// 8 bit RGB. Writes the whole file or reports an error.
Result<void> writePng(const Picture& picture, const std::filesystem::path& path);
// Any PNG, turned into 8 bit RGB (alpha dropped). Untrusted; at most 16384 pixels a side.
[[nodiscard]] Result<Picture> readPng(const std::filesystem::path& path);

// Peak signal-to-noise ratio in dB over all channels of all pixels, peak 255; infinity for
// identical pictures. Both must be of one size and not empty.
[[nodiscard]] Result<double> peakSignalToNoise(const Picture& a, const Picture& b);

}  // namespace meshfront
