// Scenes of several meshes on llvmpipe or a GPU: items and counts over all of them, transforms, and
// counts that arrive later.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <glm/gtc/matrix_transform.hpp>
#include <numeric>
#include <thread>

#include "shared/camera/camera_spec.h"
#include "tests/unit/drawing_fixture.h"
#include "tests/unit/generated_shapes.h"
#include "viewer/gl/pixel_counter.h"

namespace meshfront {
namespace {

using testing::GridShape;
using testing::sphereShape;
using InstanceCounts = std::vector<std::vector<uint32_t>>;

class DrawingScenes : public DrawingTest {
 protected:
  DrawingScenes() : DrawingTest({320, 200}) {}
  static GpuMesh uploaded(const GridShape& shape) {
    GpuMesh mesh;
    EXPECT_TRUE(mesh.update({shape.quantization, shape.positions, shape.triangles, 1}));
    return mesh;
  }
  std::vector<uint32_t> items(std::span<const MeshInstance> scene, const Camera& camera,
                              const Bounds& bounds) {
    renderer_->drawItems(*target_, scene, camera, bounds);
    std::vector<uint32_t> drawn;
    target_->readItems(drawn);
    return drawn;
  }
};

uint64_t coveredPixels(const std::vector<uint32_t>& items) {
  return static_cast<uint64_t>(
      std::count_if(items.begin(), items.end(), [](uint32_t item) { return item != 0; }));
}

uint64_t sumOfCounts(const std::vector<uint32_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), uint64_t{0});
}

const Bounds kRoom{glm::dvec3(-4), glm::dvec3(4)};

Camera farFromRoom() {
  return {{0, 1, 12}, {0, 0, 0}, {0, 1, 0}, 0.6};
}

TEST_F(DrawingScenes, ItemsNumberTheFacesOfAllInstances) {
  const GpuMesh fine = uploaded(sphereShape(3));
  const GpuMesh coarse = uploaded(sphereShape(1));
  const std::array<MeshInstance, 3> scene = {
      MeshInstance{&fine, glm::translate(glm::dmat4(1), {-2.5, 0, 0})}, MeshInstance{&coarse},
      MeshInstance{&fine, glm::translate(glm::dmat4(1), {2.5, 0, 0})}};
  EXPECT_EQ(faceSlotsOf(scene), 512U + 32 + 512);
  EXPECT_EQ(faceOfItem(scene, 0), std::nullopt);
  EXPECT_EQ(faceOfItem(scene, 1), (SceneFace{0, 0}));
  EXPECT_EQ(faceOfItem(scene, 512), (SceneFace{0, 511}));
  EXPECT_EQ(faceOfItem(scene, 513), (SceneFace{1, 0}));
  EXPECT_EQ(faceOfItem(scene, 545), (SceneFace{2, 0}));
  EXPECT_EQ(faceOfItem(scene, 1056), (SceneFace{2, 511}));
  EXPECT_EQ(faceOfItem(scene, 1057), std::nullopt);
  EXPECT_EQ(faceOfItem(scene, UINT32_MAX), std::nullopt);
  const std::vector<uint32_t> drawn = items(scene, farFromRoom(), kRoom);
  // From left to right in the middle row: the first, the second, the third.
  size_t last = 0;
  std::array<size_t, 3> seen{};
  for (size_t x = 0; x < 320; ++x) {
    const auto face = faceOfItem(scene, drawn[size_t{100} * 320 + x]);
    if (!face) continue;
    EXPECT_GE(face->instance, last);
    last = face->instance;
    ++seen.at(last);
  }
  for (const size_t pixels : seen) EXPECT_GT(pixels, 20U);
}

TEST_F(DrawingScenes, CountsOfInstancesAddUp) {
  const GpuMesh fine = uploaded(sphereShape(5, 0.2));
  const GpuMesh coarse = uploaded(sphereShape(2, 0.2));
  // The second hides part of the first.
  const std::array<MeshInstance, 3> scene = {
      MeshInstance{&fine, glm::translate(glm::dmat4(1), {-0.8, 0, -1})},
      MeshInstance{&coarse, glm::rotate(glm::dmat4(1), 0.7, {1, 2, 3})},
      MeshInstance{&fine, glm::scale(glm::translate(glm::dmat4(1), {2, 0, 0}), {0.5, 1, 1})}};
  const std::vector<uint32_t> drawn = items(scene, farFromRoom(), kRoom);
  for (const PixelCounter::Method method :
       {PixelCounter::Method::compute, PixelCounter::Method::readBack}) {
    PixelCounter counter = PixelCounter::create(method);
    InstanceCounts counts;
    counter.count(*target_, scene, counts);
    ASSERT_EQ(counts.size(), 3U);
    uint64_t sum = 0;
    for (size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(counts[i].size(), scene.at(i).mesh->vertexCount());
      EXPECT_GT(sumOfCounts(counts[i]), 0U);
      sum += sumOfCounts(counts[i]);
    }
    EXPECT_EQ(sum, 3 * coveredPixels(drawn));
    InstanceCounts reference;
    countPixels(drawn, scene, reference);
    EXPECT_EQ(counts, reference);
  }
}

TEST_F(DrawingScenes, ATransformedMeshIsTheMeshMadeThere) {
  const GpuMesh here = uploaded(sphereShape(4, 0.2));
  const GpuMesh there = uploaded(sphereShape(4, 0.2, {1, -0.5, 0.25}, 2));
  glm::dmat4 moved = glm::translate(glm::dmat4(1), {1, -0.5, 0.25});
  moved = glm::scale(moved, glm::dvec3(2));
  renderer_->draw(*target_, std::array{MeshInstance{&here, moved}}, farFromRoom(), kRoom, {});
  const Picture byTransform = target_->readPicture();
  renderer_->draw(*target_, there, farFromRoom(), kRoom, {});
  EXPECT_GT(peakSignalToNoise(byTransform, target_->readPicture()).value(), 40);
}

TEST_F(DrawingScenes, GeoreferencedInstancesLoseNothing) {
  const GpuMesh mesh = uploaded(sphereShape(5, 0.2));
  const auto drawnAt = [&](const glm::dvec3& place) {
    Camera camera{{0.3, 0.2, 1.35}, {0, 0, 1}, {0, 1, 0}, 0.9};  // close to the surface
    camera.eye += place;
    camera.target += place;
    const Bounds bounds{place - 1.2, place + 1.2};
    return items(std::array{MeshInstance{&mesh, glm::translate(glm::dmat4(1), place)}}, camera,
                 bounds);
  };
  const std::vector<uint32_t> near = drawnAt(glm::dvec3(0));
  const std::vector<uint32_t> far = drawnAt({4.1e6, 5.3e6, 120});
  ASSERT_GT(coveredPixels(near), 30'000U);
  size_t same = 0;
  for (size_t i = 0; i < near.size(); ++i) same += near[i] == far[i] ? 1 : 0;
  // Doubles have steps of a nanometre there: a pixel on an edge may fall to the other side.
  EXPECT_GT(same, near.size() - near.size() / 1000);
}

TEST_F(DrawingScenes, AMirroredMeshIsLitFromTheSameSide) {
  const GpuMesh mesh = uploaded(sphereShape(4));
  renderer_->draw(*target_, mesh, farFromRoom(), kRoom, {});
  const Picture plain = target_->readPicture();
  renderer_->draw(*target_, std::array{MeshInstance{&mesh, glm::scale(glm::dmat4(1), {-1, 1, 1})}},
                  farFromRoom(), kRoom, {});
  EXPECT_GT(peakSignalToNoise(plain, target_->readPicture()).value(), 45);
}

TEST_F(DrawingScenes, WhatCannotBeSeenIsLeftOut) {
  const GpuMesh mesh = uploaded(sphereShape(3));
  const Projection projection = Projection::fit(farFromRoom(), kRoom, 1.6);
  const auto seen = [&](const glm::dvec3& place) {
    const MeshInstance instance{&mesh, glm::translate(glm::dmat4(1), place)};
    return InstanceView::of(instance, projection).mayBeSeen(mesh.quantization());
  };
  EXPECT_TRUE(seen({0, 0, 0}));
  EXPECT_TRUE(seen({6, 0, 0}));  // part of it
  EXPECT_FALSE(seen({20, 0, 0}));
  EXPECT_FALSE(seen({0, -20, 0}));
  EXPECT_FALSE(seen({0, 0, 30}));  // behind the eye
  EXPECT_FALSE(seen({0, 1, 11}));  // before the near plane
  EXPECT_TRUE(seen({0, 1, 6}));    // across it
  const std::array<MeshInstance, 2> scene = {
      MeshInstance{&mesh, glm::translate(glm::dmat4(1), {20, 0, 0})}, MeshInstance{&mesh}};
  const std::vector<uint32_t> drawn = items(scene, farFromRoom(), kRoom);
  for (const uint32_t item : drawn)
    EXPECT_EQ(item == 0 ? 1U : faceOfItem(scene, item)->instance, 1U);
  EXPECT_GT(coveredPixels(drawn), 100U);
}

TEST_F(DrawingScenes, CountsThatArriveLaterAreTheSame) {
  for (const PixelCounter::Method method :
       {PixelCounter::Method::compute, PixelCounter::Method::readBack}) {
    GpuMesh first = uploaded(sphereShape(4, 0.2));
    const GpuMesh second = uploaded(sphereShape(2, 0.2));
    const std::array<MeshInstance, 2> scene = {
        MeshInstance{&first, glm::translate(glm::dmat4(1), {-1.5, 0, 0})},
        MeshInstance{&second, glm::translate(glm::dmat4(1), {1.5, 0, 0})}};
    PixelCounter counter = PixelCounter::create(method);
    PixelCounts taken;
    EXPECT_FALSE(counter.take(taken));
    items(scene, farFromRoom(), kRoom);
    InstanceCounts atOnce;
    counter.count(*target_, scene, atOnce);
    ASSERT_TRUE(counter.start(*target_, scene, 41));
    // What comes next changes nothing of it: another mesh, another picture, another size.
    const GridShape other = sphereShape(5);
    ASSERT_TRUE(first.update({other.quantization, other.positions, other.triangles, 2}));
    ASSERT_TRUE(target_->resize({100, 90}));
    items(scene, farFromRoom(), kRoom);
    for (int i = 0; i < 10'000 && !counter.take(taken); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_EQ(taken.tag, 41U);
    EXPECT_EQ(taken.pixels, atOnce);
    ASSERT_EQ(taken.changeCounts.size(), 2U);
    EXPECT_EQ(taken.changeCounts[0], 1U);
    EXPECT_FALSE(counter.take(taken));
    ASSERT_TRUE(target_->resize({320, 200}));
  }
}

TEST_F(DrawingScenes, NoMoreCountsAreUnderWayThanMayBeAndTheLatestIsTaken) {
  const GpuMesh mesh = uploaded(sphereShape(4));
  const std::array<MeshInstance, 1> scene = {MeshInstance{&mesh}};
  for (const PixelCounter::Method method :
       {PixelCounter::Method::compute, PixelCounter::Method::readBack}) {
    PixelCounter counter = PixelCounter::create(method);
    items(scene, farFromRoom(), kRoom);
    uint64_t tag = 0;
    for (; tag < PixelCounter::kMostUnderWay; ++tag)
      EXPECT_TRUE(counter.start(*target_, scene, tag, 4));
    EXPECT_FALSE(counter.start(*target_, scene, tag));
    InstanceCounts atOnce;
    counter.count(*target_, scene, atOnce);  // waits for those before it
    for (uint32_t& count : atOnce[0]) count *= 4;
    PixelCounts taken;
    for (int i = 0; i < 10'000 && taken.tag != tag - 1; ++i) {
      if (!counter.take(taken)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_EQ(taken.tag, tag - 1);
    EXPECT_EQ(taken.pixels, atOnce);
    EXPECT_EQ(counter.underWay(), 0U);
    const size_t bytes = counter.byteCount();
    EXPECT_TRUE(counter.start(*target_, scene, 7));
    EXPECT_EQ(counter.byteCount(), bytes);  // buffers are used again
    EXPECT_TRUE(counter.milliseconds().has_value());
  }
}

TEST_F(DrawingScenes, AnEmptySceneIsBackground) {
  renderer_->draw(*target_, std::span<const MeshInstance>(), farFromRoom(), kRoom, {});
  PixelCounter counter = PixelCounter::create();
  ASSERT_TRUE(counter.start(*target_, {}, 1));
  PixelCounts taken;
  EXPECT_TRUE(counter.take(taken));
  EXPECT_TRUE(taken.pixels.empty());
  const Picture picture = target_->readPicture();
  EXPECT_EQ(std::count(picture.rgb.begin(), picture.rgb.end(), picture.rgb[0]), 320 * 200);
}

}  // namespace
}  // namespace meshfront
