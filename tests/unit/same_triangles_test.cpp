#include "shared/mesh/same_triangles.h"

#include <gtest/gtest.h>

#include <vector>

namespace meshfront {
namespace {

const std::vector<GridPosition> kPositions = {{0, 0, 0}, {5, 0, 0}, {0, 5, 0}, {1048575, 7, 9}};

TEST(SameTriangles, IgnoresOrderFirstCornerAndSharing) {
  const std::vector<Triangle> first = {{0, 1, 2}, {1, 3, 2}};
  const std::vector<GridPosition> otherPositions = {{0, 5, 0}, {1048575, 7, 9}, {5, 0, 0},
                                                    {5, 0, 0}, {0, 5, 0},       {0, 0, 0}};
  const std::vector<Triangle> second = {{0, 2, 1}, {3, 4, 5}};
  EXPECT_TRUE(compareTriangles(kPositions, first, otherPositions, second).equal());
}

TEST(SameTriangles, SeesOrientation) {
  const std::vector<Triangle> first = {{0, 1, 2}};
  const std::vector<Triangle> second = {{0, 2, 1}};
  const auto difference = compareTriangles(kPositions, first, kPositions, second);
  EXPECT_FALSE(difference.equal());
  EXPECT_EQ(difference.missingInFirst, 1U);
  EXPECT_EQ(difference.missingInSecond, 1U);
}

TEST(SameTriangles, CountsMultiplicity) {
  const std::vector<Triangle> first = {{0, 1, 2}, {1, 2, 0}, {0, 1, 3}};
  const std::vector<Triangle> second = {{0, 1, 2}, {1, 2, 3}, {2, 3, 1}};
  const auto difference = compareTriangles(kPositions, first, kPositions, second);
  EXPECT_EQ(difference.missingInFirst, 2U);
  EXPECT_EQ(difference.missingInSecond, 2U);
}

TEST(SameTriangles, SeesEveryCoordinate) {
  const std::vector<Triangle> triangle = {{0, 1, 2}};
  for (size_t corner = 0; corner < 3; ++corner) {
    for (size_t axis = 0; axis < 3; ++axis) {
      auto moved = kPositions;
      moved[corner][axis] += 1;
      EXPECT_FALSE(compareTriangles(kPositions, triangle, moved, triangle).equal());
    }
  }
}

TEST(SameTriangles, ComparesDegenerateOnes) {
  const std::vector<Triangle> first = {{0, 0, 1}, {2, 2, 2}};
  const std::vector<Triangle> same = {{2, 2, 2}, {1, 0, 0}};
  const std::vector<Triangle> other = {{2, 2, 2}, {1, 1, 0}};
  EXPECT_TRUE(compareTriangles(kPositions, first, kPositions, same).equal());
  EXPECT_FALSE(compareTriangles(kPositions, first, kPositions, other).equal());
}

TEST(SameTriangles, TakesEmptySets) {
  EXPECT_TRUE(compareTriangles({}, {}, {}, {}).equal());
  const std::vector<Triangle> one = {{0, 1, 2}};
  EXPECT_EQ(compareTriangles({}, {}, kPositions, one).missingInFirst, 1U);
}

}  // namespace
}  // namespace meshfront
