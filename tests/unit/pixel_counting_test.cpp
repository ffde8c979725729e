// Drawing one mesh, and the pixels that its vertices cover: on the GPU, read back, and by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

#include "shared/camera/camera_spec.h"
#include "tests/unit/drawing_fixture.h"
#include "tests/unit/generated_shapes.h"
#include "viewer/gl/pixel_counter.h"

namespace meshfront {
namespace {

using testing::GridShape;
using testing::planeShape;
using testing::sphereShape;

Bounds boundsOf(const GridShape& shape) {
  GridPosition low = shape.positions.front();
  GridPosition high = low;
  for (const GridPosition& p : shape.positions) {
    for (size_t i = 0; i < 3; ++i) {
      low.at(i) = std::min(low.at(i), p.at(i));
      high.at(i) = std::max(high.at(i), p.at(i));
    }
  }
  return Bounds::of(shape.quantization.toWorld(low), shape.quantization.toWorld(high));
}

MeshArrays arraysOf(const GridShape& shape, uint64_t changeCount = 1) {
  return {shape.quantization, shape.positions, shape.triangles, changeCount};
}

Camera wholeCamera(const Bounds& bounds) {
  return placeCamera(CameraSpec{}, bounds, 1);
}

class PixelCounting : public DrawingTest {
 protected:
  PixelCounting() : DrawingTest({64, 64}) {}
  RenderTarget& target(PixelSize size) {
    EXPECT_TRUE(target_->resize(size));
    return *target_;
  }
  std::vector<uint32_t> counts(const RenderTarget& target, const GpuMesh& mesh,
                               PixelCounter::Method method) {
    auto counter = PixelCounter::create(method);
    EXPECT_EQ(counter.fallbackReason(), "");
    std::vector<uint32_t> counted;
    counter.count(target, mesh, counted);
    return counted;
  }
};

TEST_F(PixelCounting, SaysWhatDraws) {
  EXPECT_NE(context_->description().find(context_->renderer()), std::string::npos);
  RecordProperty("gl", context_->description());
}

TEST_F(PixelCounting, DrawsTheMeshsOwnColoursUnlessToldNotTo) {
  const GridShape shape = planeShape(1);
  VertexAttributes green;
  green.colour = {20, 240, 30, 255};
  const std::vector<VertexAttributes> coloured(shape.positions.size(), green);
  MeshArrays arrays = arraysOf(shape);
  arrays.coloured = coloured;
  GpuMesh mesh;
  ASSERT_TRUE(mesh.update(arrays).value());
  EXPECT_TRUE(mesh.hasColours());
  RenderTarget& drawn = target({16, 16});
  const auto middle = [&](const DrawStyle& style) {
    renderer_->draw(drawn, mesh, planeCamera(), boundsOf(shape), style);
    const Picture picture = drawn.readPicture();
    const size_t at = 3 * (size_t{16} * 8 + 8);
    return std::array<int, 3>{picture.rgb[at], picture.rgb[at + 1], picture.rgb[at + 2]};
  };
  const auto own = middle({});
  EXPECT_GT(own[1], 2 * own[0]);
  EXPECT_GT(own[1], 2 * own[2]);
  DrawStyle clayStyle;
  clayStyle.colours = false;
  const auto clay = middle(clayStyle);
  EXPECT_GT(clay[0], clay[1]);

  // Without colours again, and with too few of them.
  arrays.coloured = {};
  arrays.changeCount = 2;
  ASSERT_TRUE(mesh.update(arrays).value());
  EXPECT_EQ(middle({}), clay);
  arrays.coloured = std::span(coloured).first(2);
  arrays.changeCount = 3;
  EXPECT_FALSE(mesh.update(arrays));
}

TEST_F(PixelCounting, SquareThatFillsThePictureCountsEveryPixel) {
  const GridShape shape = planeShape(1);
  GpuMesh mesh;
  ASSERT_TRUE(mesh.update(arraysOf(shape)).value());
  RenderTarget& picture = target({64, 64});
  renderer_->drawItems(picture, mesh, planeCamera(), boundsOf(shape));
  for (const auto method : {PixelCounter::Method::compute, PixelCounter::Method::readBack}) {
    const auto counted = counts(picture, mesh, method);
    ASSERT_EQ(counted.size(), 4U);
    // Corner 0 and 3 lie on the diagonal; the pixels on it belong to one of the two triangles.
    EXPECT_EQ(counted[0], 64U * 64);
    EXPECT_EQ(counted[3], 64U * 64);
    EXPECT_EQ(counted[1] + counted[2], 64U * 64);
    EXPECT_NEAR(counted[1], 32 * 64, 64);
  }
}

TEST_F(PixelCounting, ItemsNameTheTrianglesByFaceSlot) {
  const GridShape shape = planeShape(4);  // squares of 16 pixels
  GpuMesh mesh;
  ASSERT_TRUE(mesh.update(arraysOf(shape)).value());
  RenderTarget& picture = target({64, 64});
  renderer_->draw(picture, mesh, planeCamera(), boundsOf(shape), {});
  std::vector<uint32_t> items;
  picture.readItems(items);
  for (uint32_t y = 0; y < 4; ++y) {
    for (uint32_t x = 0; x < 4; ++x) {
      const uint32_t lower = 2 * (4 * y + x);  // below the diagonal
      EXPECT_EQ(items[(16 * y + 2) * 64 + 16 * x + 13], lower + 1);
      EXPECT_EQ(items[(16 * y + 13) * 64 + 16 * x + 2], lower + 2);
    }
  }
}

TEST_F(PixelCounting, DrawAndDrawItemsMakeTheSameItems) {
  const GridShape shape = sphereShape(4, 0.2);
  GpuMesh mesh;
  ASSERT_TRUE(mesh.update(arraysOf(shape)).value());
  const Bounds bounds = boundsOf(shape);
  RenderTarget& picture = target({200, 150});
  std::vector<uint32_t> drawn;
  std::vector<uint32_t> only;
  renderer_->draw(picture, mesh, wholeCamera(bounds), bounds, {});
  picture.readItems(drawn);
  const Picture before = picture.readPicture();
  renderer_->drawItems(picture, mesh, wholeCamera(bounds), bounds);
  picture.readItems(only);
  EXPECT_EQ(drawn, only);
  EXPECT_EQ(picture.readPicture(), before);
  EXPECT_GT(std::count_if(drawn.begin(), drawn.end(), [](uint32_t i) { return i != 0; }), 5000);
}

TEST_F(PixelCounting, UndrawnTrianglesDrawNothingAndKeepTheSlots) {
  GridShape shape = planeShape(2);
  const Triangle kept = shape.triangles[5];
  for (Triangle& triangle : shape.triangles) {
    triangle = {0, 0, 0};
  }
  GpuMesh mesh;
  ASSERT_TRUE(mesh.update(arraysOf(shape, 1)).value());
  RenderTarget& picture = target({64, 64});
  std::vector<uint32_t> items;
  renderer_->draw(picture, mesh, planeCamera(), boundsOf(shape), {});
  picture.readItems(items);
  EXPECT_EQ(std::count(items.begin(), items.end(), 0U), 64 * 64);
  EXPECT_EQ(picture.depthAt(32, 32), 0);
  EXPECT_EQ(picture.depthAt(-1, 64), 0);

  shape.triangles[5] = kept;
  ASSERT_TRUE(mesh.update(arraysOf(shape, 2)).value());
  renderer_->draw(picture, mesh, planeCamera(), boundsOf(shape), {});
  picture.readItems(items);
  EXPECT_EQ(std::count_if(items.begin(), items.end(), [](uint32_t i) { return i == 6; }),
            (64 * 64) - std::count(items.begin(), items.end(), 0U));
  EXPECT_NEAR(std::count(items.begin(), items.end(), 6U), 512, 32);
}

TEST_F(PixelCounting, EmptyMeshDrawsAndCountsNothing) {
  GpuMesh mesh;
  RenderTarget& picture = target({16, 16});
  renderer_->draw(picture, mesh, planeCamera(), Bounds{}, {});
  EXPECT_TRUE(counts(picture, mesh, PixelCounter::Method::compute).empty());
  EXPECT_TRUE(counts(picture, mesh, PixelCounter::Method::readBack).empty());
  const Picture seen = picture.readPicture();
  EXPECT_EQ(std::count(seen.rgb.begin(), seen.rgb.end(), seen.rgb[0]), 16 * 16);
}

TEST_F(PixelCounting, ComputeAndReadBackAgreeExactly) {
  std::vector<GridShape> shapes = {sphereShape(1), sphereShape(3, 0.3), sphereShape(6, 0.1)};
  const GridShape far = sphereShape(5, 0.2, {4.1e6, 5.3e6, 120}, 850);
  shapes.push_back(far);
  RenderTarget& picture = target({1, 1});
  for (const GridShape& shape : shapes) {
    GpuMesh mesh;
    ASSERT_TRUE(mesh.update(arraysOf(shape)).value());
    const Bounds bounds = boundsOf(shape);
    for (const char* view : {"whole", "half;azimuth=200", "close"}) {
      // Sizes that divide into no whole number of work groups too.
      for (const PixelSize size : {PixelSize{333, 97}, PixelSize{64, 64}, PixelSize{3, 51}}) {
        ASSERT_TRUE(picture.resize(size));
        const Camera camera = placeCamera(*parseCameraSpec(view), bounds, size.aspect());
        renderer_->drawItems(picture, mesh, camera, bounds);
        const auto gpu = counts(picture, mesh, PixelCounter::Method::compute);
        const auto cpu = counts(picture, mesh, PixelCounter::Method::readBack);
        EXPECT_EQ(gpu, cpu) << shape.triangles.size() << ' ' << view << ' ' << size.width;
        std::vector<uint32_t> items;
        picture.readItems(items);
        const auto covered = static_cast<uint64_t>(
            std::count_if(items.begin(), items.end(), [](uint32_t i) { return i != 0; }));
        EXPECT_EQ(std::accumulate(gpu.begin(), gpu.end(), uint64_t{0}), 3 * covered);
        EXPECT_GT(covered, 0U) << view << ' ' << size.width;
      }
    }
  }
}

TEST_F(PixelCounting, HiddenVerticesCountNothing) {
  const GridShape shape = sphereShape(4);
  GpuMesh mesh;
  ASSERT_TRUE(mesh.update(arraysOf(shape)).value());
  const Bounds bounds = boundsOf(shape);
  const Camera camera = placeCamera(*parseCameraSpec("azimuth=0;elevation=0"), bounds, 1);
  RenderTarget& picture = target({256, 256});
  renderer_->drawItems(picture, mesh, camera, bounds);
  const auto counted = counts(picture, mesh, PixelCounter::Method::compute);
  for (size_t v = 0; v < counted.size(); ++v) {
    const double z = shape.quantization.toWorld(shape.positions[v])[2];
    if (z < -0.1) {
      EXPECT_EQ(counted[v], 0U) << v;
    }
    if (z > 0.6) {
      EXPECT_GT(counted[v], 0U) << v;
    }
  }
}

TEST_F(PixelCounting, UploadsOnlyWhatChanged) {
  GridShape shape = sphereShape(2);
  GpuMesh mesh;
  EXPECT_TRUE(mesh.update(arraysOf(shape, 7)).value());
  EXPECT_FALSE(mesh.update(arraysOf(shape, 7)).value());
  const GridShape finer = sphereShape(3);
  EXPECT_TRUE(mesh.update(arraysOf(finer, 8)).value());
  EXPECT_EQ(mesh.triangleCount(), finer.triangles.size());
  EXPECT_TRUE(mesh.update(arraysOf(shape, 9)).value());
  EXPECT_EQ(mesh.triangleCount(), shape.triangles.size());
}

TEST_F(PixelCounting, CornersOutOfRangeAreRefused) {
  GridShape shape = planeShape(1);
  GpuMesh mesh;
  ASSERT_TRUE(mesh.update(arraysOf(shape, 1)).value());
  shape.triangles[1][2] = 4;
  const auto updated = mesh.update(arraysOf(shape, 2));
  ASSERT_FALSE(updated);
  EXPECT_NE(updated.error().message.find("triangle 1"), std::string::npos);
  EXPECT_EQ(mesh.corners()[1], planeShape(1).triangles[1]);
}

TEST_F(PixelCounting, ResizeChangesTheCounts) {
  const GridShape shape = planeShape(1);
  GpuMesh mesh;
  ASSERT_TRUE(mesh.update(arraysOf(shape)).value());
  RenderTarget& picture = target({64, 64});
  for (const int side : {64, 200, 31}) {
    ASSERT_TRUE(picture.resize({side, side}));
    renderer_->drawItems(picture, mesh, planeCamera(), boundsOf(shape));
    EXPECT_EQ(counts(picture, mesh, PixelCounter::Method::compute)[0],
              static_cast<uint32_t>(side * side));
  }
  const auto refused = picture.resize({0, 10});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("0x10"), std::string::npos);
  EXPECT_FALSE(picture.resize({1 << 28, 10}));
  EXPECT_EQ(picture.size(), (PixelSize{31, 31}));
}

TEST_F(PixelCounting, TriangleOrderDoesNotChangeThePicture) {
  GridShape shape = sphereShape(4, 0.2);
  const Bounds bounds = boundsOf(shape);
  GpuMesh mesh;
  ASSERT_TRUE(mesh.update(arraysOf(shape, 1)).value());
  RenderTarget& picture = target({300, 300});
  renderer_->draw(picture, mesh, wholeCamera(bounds), bounds, {});
  const Picture inOrder = picture.readPicture();
  std::shuffle(shape.triangles.begin(), shape.triangles.end(), std::mt19937(1));
  ASSERT_TRUE(mesh.update(arraysOf(shape, 2)).value());
  renderer_->draw(picture, mesh, wholeCamera(bounds), bounds, {});
  EXPECT_EQ(peakSignalToNoise(inOrder, picture.readPicture()).value(),
            std::numeric_limits<double>::infinity());
}

TEST_F(PixelCounting, StylesDifferAndBothSidesAreLit) {
  GridShape shape = sphereShape(2, 0.2);
  const Bounds bounds = boundsOf(shape);
  const Camera camera = wholeCamera(bounds);
  GpuMesh mesh;
  ASSERT_TRUE(mesh.update(arraysOf(shape, 1)).value());
  RenderTarget& picture = target({200, 200});
  renderer_->draw(picture, mesh, camera, bounds, {});
  const Picture smooth = picture.readPicture();
  renderer_->draw(picture, mesh, camera, bounds, {.flatShading = true});
  const Picture flat = picture.readPicture();
  renderer_->draw(picture, mesh, camera, bounds, {.wireframe = true});
  const Picture edges = picture.readPicture();
  EXPECT_LT(peakSignalToNoise(smooth, flat).value(), 40);
  EXPECT_LT(peakSignalToNoise(smooth, edges).value(), 40);
  // Turned inside out, the sphere looks the same.
  for (Triangle& triangle : shape.triangles) {
    std::swap(triangle[1], triangle[2]);
  }
  ASSERT_TRUE(mesh.update(arraysOf(shape, 2)).value());
  renderer_->draw(picture, mesh, camera, bounds, {});
  EXPECT_GT(peakSignalToNoise(smooth, picture.readPicture()).value(), 45);
}

TEST(VertexNormals, AreaWeightedWhateverTheOrder) {
  const std::vector<GridPosition> positions = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {0, 0, 20}};
  std::vector<Triangle> triangles = {{0, 1, 2}, {0, 2, 3}, {0, 0, 0}};
  std::vector<PackedNormal> normals;
  computeVertexNormals(positions, triangles, normals);
  ASSERT_EQ(normals.size(), 4U);
  EXPECT_EQ(normals[1], (PackedNormal{0, 0, 32767, 0}));
  EXPECT_EQ(normals[3], (PackedNormal{32767, 0, 0, 0}));
  // Areas 50 and 100: (2, 0, 1) / sqrt(5).
  EXPECT_EQ(normals[0], (PackedNormal{29308, 0, 14654, 0}));
  const auto before = normals;
  std::swap(triangles[0], triangles[1]);
  std::rotate(triangles[0].begin(), triangles[0].begin() + 1, triangles[0].end());
  triangles.push_back({1, 2, 9});  // out of range
  computeVertexNormals(positions, triangles, normals);
  EXPECT_EQ(normals, before);
}

}  // namespace
}  // namespace meshfront
