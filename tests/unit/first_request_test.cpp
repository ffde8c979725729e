#include "shared/receiver/first_request.h"

#include <gtest/gtest.h>

#include <vector>

namespace meshfront {
namespace {

constexpr uint64_t kManyPixels = 1'000'000;

TEST(FirstRequest, ExpectsTwiceTheVerticesWithEachLevel) {
  EXPECT_EQ(recordsUpTo(3, 5), 1);
  EXPECT_EQ(recordsUpTo(5, 5), 1);
  EXPECT_EQ(recordsUpTo(6, 5), 3);
  EXPECT_EQ(recordsUpTo(9, 5), 31);
}

TEST(FirstRequest, TakesTheFinestLevelForWhichThereIsRoom) {
  const std::vector<uint8_t> levels(50, 0);
  EXPECT_EQ(firstSignificance(levels, kManyPixels, 400, 10), 2);  // 350; level 3 would be 750
  EXPECT_EQ(firstSignificance(levels, kManyPixels, 350, 10), 2);
  EXPECT_EQ(firstSignificance(levels, kManyPixels, 349, 10), 1);
  EXPECT_EQ(firstSignificance(levels, kManyPixels, 1e9, 4), 4);  // the mesh has no finer one
}

TEST(FirstRequest, TakesNoneWhereTheNodesFillTheRoomOrShowTooLittle) {
  const std::vector<uint8_t> levels(150, 0);
  EXPECT_EQ(firstSignificance(levels, kManyPixels, 400, 10), std::nullopt);
  EXPECT_EQ(firstSignificance(std::vector<uint8_t>(50, 0), 100, 400, 10), std::nullopt);
  EXPECT_EQ(firstSignificance({}, 0, 400, 10), std::nullopt);
  EXPECT_EQ(firstSignificance(levels, kManyPixels, -5, 10), std::nullopt);
}

TEST(FirstRequest, CountsNodesOfSeveralLevels) {
  EXPECT_EQ(firstSignificance(std::vector<uint8_t>{0, 3, 3}, kManyPixels, 40, 10), 4);  // 31+3+3
}

}  // namespace
}  // namespace meshfront
