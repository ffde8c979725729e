#include "shared/camera/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "shared/camera/camera_spec.h"

namespace meshfront {
namespace {

const Bounds kUnitBox{{-1, -1, -1}, {1, 1, 1}};
// A terrain tile far from the origin, in metres.
const Bounds kFarTile{{4.1e6, 5.3e6, 200}, {4.11e6, 5.31e6, 900}};

Camera placed(std::string_view spec, const Bounds& bounds = kUnitBox, double aspect = 1) {
  auto parsed = parseCameraSpec(spec);
  EXPECT_TRUE(parsed) << parsed.error().message;
  return placeCamera(parsed.value_or(CameraSpec{}), bounds, aspect);
}

std::string errorOf(std::string_view spec) {
  const auto parsed = parseCameraSpec(spec);
  return parsed ? "" : parsed.error().message;
}

// Where a world point falls in the picture, (-1,-1) lower left to (1,1) upper right, and its depth.
glm::dvec3 projected(const Projection& projection, const glm::dvec3& world,
                     const glm::dvec3& origin) {
  const glm::dvec4 clip = projection.clipFrom(origin) * glm::dvec4(world - origin, 1);
  return glm::dvec3(clip) / clip.w;
}

void expectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
  EXPECT_LE(glm::length(a - b), tolerance)
      << a.x << ' ' << a.y << ' ' << a.z << " against " << b.x << ' ' << b.y << ' ' << b.z;
}

TEST(CameraSpec, EmptyAndWholeAreTheDefault) {
  EXPECT_EQ(placed(""), placed("whole"));
  EXPECT_EQ(placed("whole"), placed("azimuth=30;elevation=20;zoom=1;fov=35"));
}

TEST(CameraSpec, WholeFitsTheBoxInThePicture) {
  for (const Bounds& bounds : {kUnitBox, kFarTile, Bounds{{0, 0, 0}, {9, 1, 2}}}) {
    for (const double aspect : {0.5, 1.0, 16.0 / 9}) {
      const auto projection = Projection::fit(placed("whole", bounds, aspect), bounds, aspect);
      double farthest = 0;
      for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 place((corner & 1) != 0 ? bounds.max.x : bounds.min.x,
                               (corner & 2) != 0 ? bounds.max.y : bounds.min.y,
                               (corner & 4) != 0 ? bounds.max.z : bounds.min.z);
        const glm::dvec3 seen = projected(projection, place, bounds.center());
        farthest = std::max({farthest, std::abs(seen.x), std::abs(seen.y)});
        EXPECT_TRUE(seen.z >= 0 && seen.z <= 1) << seen.z;
      }
      EXPECT_NEAR(farthest, 0.96, 1e-9);
    }
  }
}

TEST(CameraSpec, AzimuthTurnsAndElevationLifts) {
  expectNear(placed("azimuth=0;elevation=0;distance=2").eye, {0, 0, 2 * std::sqrt(3.0)}, 1e-9);
  expectNear(placed("azimuth=90;elevation=0;distance=2").eye, {2 * std::sqrt(3.0), 0, 0}, 1e-9);
  expectNear(placed("azimuth=0;elevation=90;distance=1;target=1,2,3").eye,
             {1, 2 + std::sqrt(3.0), 3}, 1e-3);
  expectNear(placed("azimuth=0;elevation=0;distance=1;up=z").eye, {0, -std::sqrt(3.0), 0}, 1e-9);
  expectNear(placed("azimuth=90;elevation=0;distance=1;up=z").eye, {std::sqrt(3.0), 0, 0}, 1e-9);
}

TEST(CameraSpec, TerrainStandsOnZ) {
  EXPECT_EQ(placed("whole", kFarTile).up, glm::dvec3(0, 0, 1));
  EXPECT_EQ(placed("whole", kUnitBox).up, glm::dvec3(0, 1, 0));
}

TEST(CameraSpec, ZoomNarrowsTheViewFromTheSamePlace) {
  const Camera whole = placed("whole");
  const Camera close = placed("close");
  EXPECT_EQ(whole.eye, close.eye);
  EXPECT_NEAR(std::tan(whole.verticalFov / 2) / std::tan(close.verticalFov / 2), 4, 1e-9);
  EXPECT_NEAR(std::tan(whole.verticalFov / 2) / std::tan(placed("half").verticalFov / 2), 2, 1e-9);
}

TEST(CameraSpec, ExplicitEyeSurvivesPrinting) {
  const Camera camera =
      placed("eye=4100000.125,5.3e6,1e3; target=4105000,5305000.1,300;up=0,0.1,1;fov=42.5");
  EXPECT_EQ(camera.eye, glm::dvec3(4100000.125, 5.3e6, 1000));
  EXPECT_EQ(camera.up, glm::dvec3(0, 0.1, 1));
  const Camera again = placed(formatCamera(camera));
  EXPECT_EQ(again.eye, camera.eye);
  EXPECT_EQ(again.target, camera.target);
  EXPECT_EQ(again.up, camera.up);
  EXPECT_NEAR(again.verticalFov, camera.verticalFov, 1e-12);
  EXPECT_EQ(formatCamera(Camera{{0, 0, 2}, {0, 0, 0}, {0, 1, 0}, glm::radians(45.0)}),
            "eye=0,0,2;target=0,0,0;up=0,1,0;fov=45");
}

TEST(CameraSpec, ErrorsNameThePart) {
  EXPECT_NE(errorOf("nearby").find("'nearby'"), std::string::npos);
  EXPECT_NE(errorOf("azimuth=left").find("azimuth=DEGREES"), std::string::npos);
  EXPECT_NE(errorOf("elevation=91").find("-90 to 90"), std::string::npos);
  EXPECT_NE(errorOf("eye=1,2").find("eye=X,Y,Z"), std::string::npos);
  EXPECT_NE(errorOf("up=0,0,0").find("not all zero"), std::string::npos);
  EXPECT_NE(errorOf("eye=1,2,3;azimuth=4").find("leave out"), std::string::npos);
  EXPECT_NE(errorOf("eye=1,2,3;target=1,2,3").find("same point"), std::string::npos);
  for (const char* bad :
       {"zoom=0", "zoom=-1", "zoom=nan", "zoom=inf", "zoom=1x", "zoom=", "zoom", "fov=180",
        "distance=0", "target=1,2,3,4", "target=1,,3", "=3", "zoom=2;whole", "azimuth=1e999"}) {
    EXPECT_NE(errorOf(bad), "") << bad;
  }
  EXPECT_EQ(errorOf("whole;"), "");
}

TEST(Projection, PlanesHoldTheWholeSphereAndDepthIsReversed) {
  const Camera camera = placed("whole");
  const auto projection = Projection::fit(camera, kUnitBox, 1);
  const glm::dvec3 toMesh = glm::normalize(camera.target - camera.eye);
  const double nearDepth = projected(projection, -toMesh * kUnitBox.radius(), camera.eye).z;
  const double farDepth = projected(projection, toMesh * kUnitBox.radius(), camera.eye).z;
  EXPECT_LE(nearDepth, 1);
  EXPECT_GE(farDepth, 0);
  EXPECT_GT(nearDepth, farDepth);
  EXPECT_GT(nearDepth, 0.9);
  EXPECT_LT(farDepth, 0.1);
}

TEST(Projection, EyeInsideTheBoundsKeepsANearPlaneAhead) {
  const Camera camera{{0, 0, 0.1}, {0, 0, 0}, {0, 1, 0}, 0.6};
  const auto projection = Projection::fit(camera, kUnitBox, 1);
  EXPECT_GT(projection.nearPlane, 0);
  EXPECT_LT(projection.nearPlane, 1e-3);
  EXPECT_GT(projection.farPlane, projection.nearPlane);
  const Camera away{{0, 0, 10}, {0, 0, 20}, {0, 1, 0}, 0.6};  // the mesh is behind
  EXPECT_GT(Projection::fit(away, kUnitBox, 1).farPlane, 0);
}

TEST(Projection, WorldPointUndoesTheProjection) {
  for (const Bounds& bounds : {kUnitBox, kFarTile}) {
    const double scale = bounds.radius();
    const auto projection = Projection::fit(placed("half", bounds, 1.5), bounds, 1.5);
    const glm::dvec3 world = bounds.center() + glm::dvec3(0.1, -0.2, 0.05) * scale;
    const glm::dvec3 seen = projected(projection, world, bounds.min);
    expectNear(projection.worldPoint(seen, seen.z), world, 1e-8 * scale);
  }
}

TEST(Projection, GeoreferencedPlacesKeepMillimetres) {
  // As the GPU gets it: a float matrix relative to a point near the eye.
  Camera camera{{4.105e6, 5.305e6, 302}, {4.105001e6, 5.305e6, 300}, {0, 0, 1}, 0.6};
  const auto projection = Projection::fit(camera, kFarTile, 1);
  const glm::dvec3 origin(4.105e6, 5.305e6, 300);
  const glm::mat4 matrix(projection.clipFrom(origin));
  const glm::dvec3 world = camera.target + glm::dvec3(0.001, 0, 0);
  const glm::vec4 clip = matrix * glm::vec4(glm::vec3(world - origin), 1);
  const glm::dvec3 exact = projected(projection, world, origin);
  const double pixel = 2.0 / 1000;
  EXPECT_NEAR(clip.x / clip.w, exact.x, 0.05 * pixel);
  EXPECT_NEAR(clip.y / clip.w, exact.y, 0.05 * pixel);
}

TEST(ViewAxes, AreOrthonormalEvenLookingAlongUp) {
  for (const glm::dvec3 eye : {glm::dvec3(0, 5, 0), glm::dvec3(1, 2, 3), glm::dvec3(0, -5, 0)}) {
    const ViewAxes axes = viewAxes({eye, {0, 0, 0}, {0, 1, 0}, 0.6});
    expectNear(glm::cross(axes.right, axes.upward), -axes.forward, 1e-12);
    EXPECT_NEAR(glm::length(axes.right), 1, 1e-12);
  }
}

TEST(Moves, OrbitKeepsTheDistanceAndStopsAtThePole) {
  Camera camera = placed("whole");
  const double distance = glm::length(camera.eye - camera.target);
  orbit(camera, 1, 0.2);
  EXPECT_NEAR(glm::length(camera.eye - camera.target), distance, 1e-9);
  orbit(camera, 0, 10);
  EXPECT_GT(camera.eye.y, 0.99 * distance);
  EXPECT_LT(camera.eye.y, distance);
  orbit(camera, 0, -20);
  EXPECT_LT(camera.eye.y, -0.99 * distance);
  Camera front = placed("azimuth=0;elevation=0");
  orbit(front, glm::radians(90.0), 0);
  expectNear(front.eye, placed("azimuth=90;elevation=0").eye, 1e-9);
}

TEST(Moves, PanFollowsTheCursor) {
  Camera camera = placed("whole");
  const glm::dvec3 point = camera.target;
  pan(camera, {100, -50}, 800);
  const glm::dvec3 seen = projected(Projection::fit(camera, kUnitBox, 1), point, point);
  EXPECT_NEAR(seen.x * 400, 100, 1e-6);
  EXPECT_NEAR(seen.y * 400, -50, 1e-6);
}

TEST(Moves, ZoomKeepsThePointUnderTheCursor) {
  Camera camera = placed("whole");
  const glm::dvec3 point(0.3, 0.4, 0.5);
  const glm::dvec3 before = projected(Projection::fit(camera, kUnitBox, 1), point, point);
  const double distance = glm::length(camera.eye - point);
  zoomTo(camera, point, 0.25);
  const glm::dvec3 after = projected(Projection::fit(camera, kUnitBox, 1), point, point);
  EXPECT_NEAR(before.x, after.x, 1e-9);
  EXPECT_NEAR(before.y, after.y, 1e-9);
  EXPECT_NEAR(glm::length(camera.eye - point), 0.25 * distance, 1e-9);
}

TEST(Moves, PanByWhatIsGrabbedFollowsThat) {
  Camera camera = placed("whole");
  const ViewAxes axes = viewAxes(camera);
  const glm::dvec3 point = camera.eye + axes.forward * 0.5;
  pan(camera, {100, -50}, 800, 0.5);
  const glm::dvec3 seen = projected(Projection::fit(camera, kUnitBox, 1), point, point);
  EXPECT_NEAR(seen.x * 400, 100, 1e-6);
  EXPECT_NEAR(seen.y * 400, -50, 1e-6);
}

TEST(Moves, RollTurnsThePictureClockwiseAroundItsMiddle) {
  Camera camera = placed("whole");
  const ViewAxes before = viewAxes(camera);
  const glm::dvec3 above = camera.target + before.upward * 0.1;
  roll(camera, glm::radians(90.0));
  const glm::dvec3 seen = projected(Projection::fit(camera, kUnitBox, 1), above, above);
  EXPECT_GT(seen.x, 0.01);  // what was above is now on the right
  EXPECT_NEAR(seen.y, 0, 1e-9);
  expectNear(viewAxes(camera).forward, before.forward, 1e-12);
}

}  // namespace
}  // namespace meshfront
