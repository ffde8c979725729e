#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "shared/scene/mesh_placement.h"
#include "shared/scene/view_lift.h"
#include "shared/scene/view_prediction.h"

namespace meshfront {
namespace {

TEST(MeshPlacement, BoxesMoveWithTheirMeshes) {
  glm::dmat4 quarterTurn(0.0);  // x to y, y to -x
  quarterTurn[0][1] = 1;
  quarterTurn[1][0] = -1;
  quarterTurn[2][2] = quarterTurn[3][3] = 1;
  quarterTurn[3][0] = 10;
  const Bounds moved = movedBounds({{1, 2, 3}, {4, 6, 8}}, quarterTurn);
  EXPECT_EQ(moved.min, glm::dvec3(4, 1, 3));
  EXPECT_EQ(moved.max, glm::dvec3(8, 4, 8));
  const Bounds both = unitedBounds(moved, {{0, 2, 2}, {5, 9, 3}});
  EXPECT_EQ(both.min, glm::dvec3(0, 1, 2));
  EXPECT_EQ(both.max, glm::dvec3(8, 9, 8));
}

TEST(MeshPlacement, HalfAsLargeIsTwoLevelsBehind) {
  EXPECT_EQ(levelsBehind(1, 1), 0U);
  EXPECT_EQ(levelsBehind(0.5, 1), 2U);
  EXPECT_EQ(levelsBehind(0.25, 1), 4U);
  EXPECT_EQ(levelsBehind(1e-9, 1), kMostLevelsBehind);
  EXPECT_EQ(levelsBehind(0, 1), 0U);
  const Bounds box{{-1, -1, -1}, {1, 1, 1}};
  EXPECT_DOUBLE_EQ(apparentSize(box, {0, 0, 11}), box.radius() / 10);
  EXPECT_DOUBLE_EQ(apparentSize(box, {0, 0, 0.5}), kLargestApparentSize);
}

TEST(ViewLift, FallsOffFromTheMiddle) {
  Camera camera;
  camera.eye = {0, 0, 10};
  camera.verticalFov = 2 * std::atan(0.1);  // half height: 1 at the distance of the target
  Quantization grid;
  grid.origin = {-5, -5, 0};
  grid.step = 0.01;
  // In the middle; half a half height away; at its edge; in the middle, but not seen.
  const std::vector<GridPosition> positions{
      {500, 500, 0}, {562, 500, 0}, {500, 600, 0}, {500, 500, 0}};
  const std::vector<uint32_t> pixels{5, 5, 5, 0};
  std::vector<uint8_t> lift;
  Foveation foveation;
  foveation.levels = 4;
  liftOf(positions, pixels, grid, glm::dmat4(1.0), camera, foveation, std::nullopt, lift);
  EXPECT_EQ(lift, (std::vector<uint8_t>{4, 2, 0, 0}));
  foveation.on = false;
  liftOf(positions, pixels, grid, glm::dmat4(1.0), camera, foveation, std::nullopt, lift);
  EXPECT_TRUE(lift.empty());
  const RefinedSpot spot{{0, 1, 0}, 0.5};
  liftOf(positions, pixels, grid, glm::dmat4(1.0), camera, foveation, spot, lift);
  EXPECT_EQ(lift, (std::vector<uint8_t>{0, 0, kSpotLift, 0}));
}

TEST(ViewPrediction, GoesOnAroundTheTarget) {
  ViewPrediction prediction;
  EXPECT_FALSE(prediction.ahead(0.5));
  for (int frame = 0; frame <= 6; ++frame) {
    Camera camera;
    const double angle = 0.05 * frame;
    camera.target = {1, 2, 3};
    camera.eye = camera.target + glm::dvec3(4 * std::sin(angle), 0, 4 * std::cos(angle));
    prediction.see(0.05 * frame, camera);
  }
  const auto ahead = prediction.ahead(0.2);
  ASSERT_TRUE(ahead);
  const double angle = 0.05 * 6 + 0.2;  // one radian a second
  EXPECT_NEAR(ahead->eye.x, 1 + 4 * std::sin(angle), 1e-9);
  EXPECT_NEAR(ahead->eye.y, 2, 1e-9);
  EXPECT_NEAR(ahead->eye.z, 3 + 4 * std::cos(angle), 1e-9);
  EXPECT_NEAR(glm::distance(prediction.ahead(1e6)->eye, ahead->target), 4, 1e-9);
}

Camera cameraAtHeight(double z) {
  Camera camera;
  camera.eye = {0, 0, z};
  return camera;
}

// Half way to the target in a quarter of a second.
ViewPrediction comingNearer() {
  ViewPrediction prediction;
  prediction.see(0, cameraAtHeight(8));
  prediction.see(0.25, cameraAtHeight(4));
  return prediction;
}

TEST(ViewPrediction, GoesOnNearer) {
  const ViewPrediction prediction = comingNearer();
  EXPECT_NEAR(prediction.ahead(0.125)->eye.z, 4 / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(prediction.ahead(10)->eye.z, 4 / ViewPrediction::kLargestScale, 1e-9);
}

TEST(ViewPrediction, SaysNothingOfACameraThatStands) {
  ViewPrediction prediction = comingNearer();
  for (int frame = 0; frame < 10; ++frame) prediction.see(0.3 + 0.1 * frame, cameraAtHeight(4));
  EXPECT_FALSE(prediction.ahead(0.5));
}

}  // namespace
}  // namespace meshfront
