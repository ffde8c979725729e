// Curves of pictures' quality: what was needed to come to a PSNR.
#include "tests/evaluation/quality/quality_curve.h"

#include <gtest/gtest.h>

#include <cmath>

namespace meshfront::evaluation {
namespace {

const QualityCurve kQualityCurve = {
    {1'000, 100, 0, 20}, {2'000, 200, 50, 25}, {8'000, 300, 250, 35}, {9'000, 400, 300, 34}};

TEST(QualityCurve, InterpolatesOverTheLogarithm) {
  ASSERT_TRUE(bytesTo(kQualityCurve, 30));
  EXPECT_NEAR(*bytesTo(kQualityCurve, 30), 4'000, 1e-6);
  EXPECT_NEAR(*bytesTo(kQualityCurve, 25), 2'000, 1e-6);
  EXPECT_NEAR(*recordsTo(kQualityCurve, 35), 250, 1e-6);
}

TEST(QualityCurve, IsStraightFromNothing) {
  EXPECT_NEAR(*recordsTo(kQualityCurve, 22.5), 25, 1e-6);
}

TEST(QualityCurve, StartsWithItsFirstPoint) {
  EXPECT_NEAR(*bytesTo(kQualityCurve, 12), 1'000, 1e-6);
}

TEST(QualityCurve, TellsWhatItNeverReaches) {
  EXPECT_FALSE(bytesTo(kQualityCurve, 35.1));
  EXPECT_FALSE(bytesTo({}, 10));
}

TEST(QualityCurve, TakesTheFirstTime) {
  // It falls below 35 dB again later.
  EXPECT_NEAR(*bytesTo(kQualityCurve, 34.5), 8'000 * std::pow(0.25, 0.05), 1e-6);
}

TEST(MeasuringPoints, GrowByTheFactor) {
  MeasuringPoints points(1'000, 1.1);
  EXPECT_TRUE(points.isDue(1'000));
  points.measuredAt(1'000);
  EXPECT_FALSE(points.isDue(1'099));
  EXPECT_TRUE(points.isDue(1'100));
  points.measuredAt(1'500);
  EXPECT_EQ(points.next(), 1'650U);
}

TEST(MeasuringPoints, GrowByOneAtLeast) {
  MeasuringPoints points(1, 1.01);
  points.measuredAt(1);
  EXPECT_EQ(points.next(), 2U);
}

}  // namespace
}  // namespace meshfront::evaluation
