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

TEST(FirstRequest, CountsTheNodesThatHaveRoomOneLevelFiner) {
  const std::vector<uint8_t> levels(50, 0);
  EXPECT_EQ(nodesOneLevelFiner(levels, 2, 400, 10), 26U);  // 15 records each up to level 3
  EXPECT_EQ(nodesOneLevelFiner(levels, 2, 750, 10), 50U);
  EXPECT_EQ(nodesOneLevelFiner(levels, 2, 14, 10), 0U);
  EXPECT_EQ(nodesOneLevelFiner(levels, 2, 400, 2), 0U);  // there is no finer one
  EXPECT_EQ(nodesOneLevelFiner(std::vector<uint8_t>{3, 0, 0}, 2, 17, 10), 2U);  // 1 + 15
  EXPECT_EQ(nodesOneLevelFiner({}, 2, 400, 10), 0U);
}

}  // namespace
}  // namespace meshfront
