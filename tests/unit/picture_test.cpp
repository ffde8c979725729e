#include "viewer/picture/picture.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace meshfront {
namespace {

Picture gradient(int width, int height) {
  Picture picture{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      picture.rgb.push_back(static_cast<uint8_t>(x * 7));
      picture.rgb.push_back(static_cast<uint8_t>(y * 11));
      picture.rgb.push_back(static_cast<uint8_t>(x ^ y));
    }
  }
  return picture;
}

class PngFile : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = std::filesystem::temp_directory_path() /
            ("meshfront-picture-" + std::to_string(getpid()) + ".png");
  }
  void TearDown() override { std::filesystem::remove(path_); }
  std::filesystem::path path_;
};

TEST_F(PngFile, GivesBackEveryByte) {
  const Picture picture = gradient(37, 23);
  ASSERT_TRUE(writePng(picture, path_));
  const auto again = readPng(path_);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(*again, picture);
}

TEST_F(PngFile, ErrorsAreValues) {
  EXPECT_FALSE(readPng(path_));
  EXPECT_FALSE(writePng(Picture{}, path_));
  EXPECT_FALSE(writePng(Picture{2, 2, {1, 2, 3}}, path_));
  const auto unwritable = writePng(gradient(2, 2), "/nonexistent-folder/picture.png");
  ASSERT_FALSE(unwritable);
  EXPECT_NE(unwritable.error().message.find("/nonexistent-folder/picture.png"), std::string::npos);
}

TEST_F(PngFile, EveryTruncationIsAnError) {
  ASSERT_TRUE(writePng(gradient(9, 5), path_));
  std::ifstream file(path_, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  // The last 12 bytes are the empty IEND chunk, which holds nothing of the picture.
  for (size_t length = 0; length + 12 < bytes.size(); ++length) {
    std::ofstream(path_, std::ios::binary | std::ios::trunc) << bytes.substr(0, length);
    EXPECT_FALSE(readPng(path_)) << length;
  }
}

TEST_F(PngFile, ClaimedSizeBeyondTheBytesIsRefused) {
  ASSERT_TRUE(writePng(gradient(9, 5), path_));
  std::fstream file(path_, std::ios::binary | std::ios::in | std::ios::out);
  // Width and height of 16384 and the header chunk's checksum for them.
  file.seekp(16);
  file.write("\x00\x00\x40\x00\x00\x00\x40\x00", 8);
  file.close();
  EXPECT_FALSE(readPng(path_));
}

TEST(PeakSignalToNoise, KnownValues) {
  const Picture a{2, 1, {10, 20, 30, 40, 50, 60}};
  EXPECT_TRUE(std::isinf(peakSignalToNoise(a, a).value()));
  Picture b = a;
  for (uint8_t& channel : b.rgb) {
    ++channel;  // a mean square of 1
  }
  EXPECT_NEAR(peakSignalToNoise(a, b).value(), 48.1308, 1e-4);
  Picture c = a;
  c.rgb[2] = 36;  // 36 / 6 channels = 6
  EXPECT_NEAR(peakSignalToNoise(a, c).value(), 10 * std::log10(65025.0 / 6), 1e-9);
  const Picture black{1, 1, {0, 0, 0}};
  const Picture white{1, 1, {255, 255, 255}};
  EXPECT_NEAR(peakSignalToNoise(black, white).value(), 0, 1e-12);
}

TEST(PeakSignalToNoise, RefusesWhatCannotBeCompared) {
  EXPECT_FALSE(peakSignalToNoise(gradient(3, 2), gradient(2, 3)));
  EXPECT_FALSE(peakSignalToNoise(Picture{}, Picture{}));
}

}  // namespace
}  // namespace meshfront
