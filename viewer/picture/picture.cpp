#include "viewer/picture/picture.h"

#include <png.h>

#include <cmath>
#include <limits>
#include <string>
#include <system_error>

namespace meshfront {
namespace {

constexpr png_uint_32 kMaxSide = 16384;

size_t byteCount(const Picture& picture) {
  return size_t{3} * static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height);
}

std::string sizeText(const Picture& picture) {
  return std::to_string(picture.width) + "x" + std::to_string(picture.height);
}

}  // namespace

// libpng's simplified interface reports errors by value; its other one needs setjmp.
Result<void> writePng(const Picture& picture, const std::filesystem::path& path) {
  if (picture.width <= 0 || picture.height <= 0 || picture.rgb.size() != byteCount(picture)) {
    return fail("picture: nothing to write to " + path.string());
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB;
  if (png_image_write_to_file(&image, path.c_str(), 0, picture.rgb.data(), 0, nullptr) == 0) {
    return fail(ErrorCode::unavailable, "cannot write " + path.string() + ": " + image.message);
  }
  return {};
}

Result<Picture> readPng(const std::filesystem::path& path) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&image, path.c_str()) == 0) {
    return fail("cannot read " + path.string() + ": " + image.message);
  }
  if (image.width > kMaxSide || image.height > kMaxSide) {
    png_image_free(&image);
    return fail(ErrorCode::tooLarge, path.string() + ": wider or higher than 16384 pixels");
  }
  // Deflate shrinks at most 1032 times: a header cannot claim more pixels than its file may hold.
  std::error_code ignored;
  const uintmax_t fileBytes = std::filesystem::file_size(path, ignored);
  if (ignored || uint64_t{image.width} * image.height / (8 * 1032) > fileBytes) {
    png_image_free(&image);
    return fail(path.string() + ": too short for its size in pixels");
  }
  image.format = PNG_FORMAT_RGB;
  Picture picture;
  picture.width = static_cast<int>(image.width);
  picture.height = static_cast<int>(image.height);
  picture.rgb.resize(byteCount(picture));
  const png_color background{255, 255, 255};
  if (png_image_finish_read(&image, &background, picture.rgb.data(), 0, nullptr) == 0) {
    return fail("cannot read " + path.string() + ": " + image.message);
  }
  return picture;
}

Result<double> peakSignalToNoise(const Picture& a, const Picture& b) {
  if (a.width != b.width || a.height != b.height) {
    return fail("pictures of different sizes cannot be compared: " + sizeText(a) + " and " +
                sizeText(b));
  }
  if (a.rgb.empty() || a.rgb.size() != b.rgb.size()) {
    return fail("an empty picture cannot be compared");
  }
  uint64_t squares = 0;
  for (size_t i = 0; i < a.rgb.size(); ++i) {
    const int difference = int{a.rgb[i]} - int{b.rgb[i]};
    squares += static_cast<uint64_t>(difference * difference);
  }
  if (squares == 0) {
    return std::numeric_limits<double>::infinity();
  }
  const double mean = static_cast<double>(squares) / static_cast<double>(a.rgb.size());
  return 10 * std::log10(255.0 * 255.0 / mean);
}

}  // namespace meshfront
