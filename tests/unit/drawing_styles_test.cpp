// What can be shown beside a mesh's surface: scales, translucent colours, slides, what is missing;
// and what lies under the cursor.
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <numeric>
#include <set>
#include <thread>

#include "shared/camera/camera_spec.h"
#include "tests/unit/drawing_fixture.h"
#include "tests/unit/generated_shapes.h"
#include "viewer/gl/colour_scales.h"
#include "viewer/gl/missing_bounds.h"
#include "viewer/gl/picking.h"
#include "viewer/gl/ranking_pass.h"
#include "viewer/gl/shader_program.h"

namespace meshfront {
namespace {

using testing::GridShape;
using testing::planeShape;
using testing::sphereShape;

const Bounds kAroundSphere{glm::dvec3(-1.2), glm::dvec3(1.2)};
const Bounds kAroundPlane{glm::dvec3(0), glm::dvec3(1, 1, 0)};

MeshUpdate wholeUpdateOf(const GridShape& shape) {
  return updateFrom({shape.quantization, shape.positions, shape.triangles, 1}).value();
}

class DrawingStyles : public DrawingTest {
 protected:
  DrawingStyles() : DrawingTest({256, 256}) {}
  Picture drawn(const GpuMesh& mesh, const Camera& camera, const Bounds& bounds,
                const DrawStyle& style, const FrameState& frame = {}) {
    renderer_->draw(*target_, std::array{MeshInstance{&mesh}}, camera, bounds, style, frame);
    return target_->readPicture();
  }
  std::vector<uint32_t> itemsNow() {
    std::vector<uint32_t> items;
    target_->readItems(items);
    return items;
  }
  // For a person to look at.
  static void keep(const Picture& picture, const std::string& name) {
    if (const char* folder = std::getenv("MESHFRONT_STYLE_PICTURES")) {
      EXPECT_TRUE(writePng(picture, std::filesystem::path(folder) / (name + ".png")));
    }
  }
};

TEST_F(DrawingStyles, ShadersComputeTheLegendsColours) {
  const std::string source = std::string("#version 450 core\n") + kColourScaleShader + R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) writeonly buffer Colours { vec4 colours[]; };
void main() {
  uint i = gl_GlobalInvocationID.x;
  colours[5u * i] = vec4(treeColour(i, 0u), 1.0);
  colours[5u * i + 1u] = vec4(treeColour(i * 7919u, 3u), 1.0);
  colours[5u * i + 2u] = vec4(levelColour(i, 31u), 1.0);
  colours[5u * i + 3u] = vec4(pixelColour(i * i * i / 50u), 1.0);
  colours[5u * i + 4u] = vec4(missingColour(i, 31u, i > 40u), 1.0);
})";
  auto program = computeProgram("scales", source);
  ASSERT_TRUE(program) << program.error().message;
  constexpr uint32_t kValues = 64;
  std::vector<std::array<float, 4>> colours(5 * kValues);
  GLuint buffer = 0;
  glCreateBuffers(1, &buffer);
  const GlBuffer owner(buffer);
  const auto bytes = static_cast<GLsizeiptr>(colours.size() * sizeof colours[0]);
  glNamedBufferStorage(buffer, bytes, nullptr, 0);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffer);
  glUseProgram(program->name());
  glDispatchCompute(1, 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(buffer, 0, bytes, colours.data());
  const auto encoded = [](float linear) {
    return linear > 0.0031308F ? 1.055F * std::pow(linear, 1 / 2.4F) - 0.055F : 12.92F * linear;
  };
  for (uint32_t i = 0; i < kValues; ++i) {
    const std::array<ShownColour, 5> expected = {
        treeColour(i), treeColour(i * 7919, 3), levelColour(i, 31),
        pixelColour(i * i * i / 50),  // NOLINT(bugprone-integer-division)
        missingColour(i, 31, i > 40)};
    for (size_t scale = 0; scale < 5; ++scale)
      for (size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(encoded(colours[5 * i + scale].at(c)), expected.at(scale).at(c), 2e-3)
            << i << ' ' << scale << ' ' << c;
  }
}

TEST(ColourScales, NeighboursDifferAndOrderShows) {
  std::set<ShownColour> trees;
  for (uint32_t tree = 0; tree < 200; ++tree) trees.insert(treeColour(tree));
  EXPECT_GT(trees.size(), 190U);
  EXPECT_NE(treeColour(5, 0), treeColour(5, 1));
  const auto brightness = [](const ShownColour& c) {
    return 0.3F * c[0] + 0.6F * c[1] + 0.1F * c[2];
  };
  for (double pixels = 1; pixels < kMostPixels / 2; pixels *= 2)
    EXPECT_LT(brightness(pixelColour(pixels)), brightness(pixelColour(2 * pixels)));
  EXPECT_EQ(pixelColour(kMostPixels), pixelColour(1e9));
  // Warm for coarse, neutral when final.
  const ShownColour coarse = missingColour(0, 20, false);
  EXPECT_GT(coarse[0], coarse[2] + 0.3F);
  const ShownColour final = missingColour(0, 20, true);
  EXPECT_NEAR(final[0], final[2], 0.07F);
}

// A sphere whose trees are its octants, with levels by height, half of it final.
MeshUpdate withScales(const GridShape& shape) {
  MeshUpdate update = wholeUpdateOf(shape);
  const int32_t middle = shape.quantization.maximum() / 2;
  for (DrawnVertex& vertex : update.vertices) {
    const GridPosition& p = vertex.position;
    vertex.tree =
        static_cast<uint32_t>((p[0] > middle) + 2 * (p[1] > middle) + 4 * (p[2] > middle));
    vertex.level = static_cast<uint8_t>(20 * int64_t{p[1]} / shape.quantization.maximum());
    vertex.isLeaf = p[0] > middle ? 1 : 0;
    vertex.colour = {static_cast<uint8_t>(p[0] * 255 / shape.quantization.maximum()), 160, 90, 255};
  }
  return update;
}

TEST_F(DrawingStyles, EveryColouringDiffersAndKeepsTheItems) {
  const GridShape shape = sphereShape(5, 0.15);
  GpuMesh mesh(shape.quantization, true);
  ASSERT_TRUE(mesh.apply(withScales(shape)));
  const Camera camera = placeCamera(CameraSpec{}, kAroundSphere, 1);
  std::vector<Picture> pictures;
  pictures.push_back(drawn(mesh, camera, kAroundSphere, {}));
  const std::vector<uint32_t> items = itemsNow();
  std::vector<std::vector<uint32_t>> counts;
  PixelCounter::create().count(*target_, std::array{MeshInstance{&mesh}}, counts);
  PixelBuffers pixels;
  ASSERT_TRUE(pixels.set(counts));
  FrameState frame;
  frame.pixels = &pixels;
  keep(pictures.back(), "surface");
  for (const auto& [colouring, name] :
       {std::pair(Colouring::tree, "tree"), std::pair(Colouring::level, "level"),
        std::pair(Colouring::pixels, "pixels"), std::pair(Colouring::missing, "missing")}) {
    DrawStyle style;
    style.colouring = colouring;
    style.finestLevel = 20;
    pictures.push_back(drawn(mesh, camera, kAroundSphere, style, frame));
    EXPECT_EQ(itemsNow(), items);
    keep(pictures.back(), name);
    style.wireframe = true;
    style.flatShading = true;
    pictures.push_back(drawn(mesh, camera, kAroundSphere, style, frame));
    EXPECT_EQ(itemsNow(), items);
    keep(pictures.back(), std::string(name) + "_wireframe_flat");
  }
  for (size_t i = 0; i < pictures.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      EXPECT_LT(peakSignalToNoise(pictures[i], pictures[j]).value(), 40) << i << ' ' << j;
  // Counts of a mesh that has grown since, of none, and of another instance.
  for (const size_t counted : {size_t{10}, size_t{0}}) {
    counts[0].resize(counted);
    ASSERT_TRUE(pixels.set(counts));
    DrawStyle style;
    style.colouring = Colouring::pixels;
    drawn(mesh, camera, kAroundSphere, style, frame);
  }
  frame.pixels = nullptr;
  DrawStyle style;
  style.colouring = Colouring::pixels;
  drawn(mesh, camera, kAroundSphere, style, frame);
}

TEST_F(DrawingStyles, TranslucentColoursLetTheirShareThrough) {
  const GridShape shape = planeShape(4);
  for (const int alpha : {0, 64, 128, 192, 255}) {
    MeshUpdate update = wholeUpdateOf(shape);
    for (DrawnVertex& vertex : update.vertices)
      vertex.colour = {200, 40, 40, static_cast<uint8_t>(alpha)};
    GpuMesh mesh(shape.quantization, true);
    ASSERT_TRUE(mesh.apply(update));
    EXPECT_EQ(mesh.isTranslucent(), alpha != 255);
    const Picture picture = drawn(mesh, planeCamera(), kAroundPlane, {});
    const std::vector<uint32_t> items = itemsNow();
    const auto seen = std::count_if(items.begin(), items.end(), [](uint32_t i) { return i != 0; });
    EXPECT_NEAR(static_cast<double>(seen) / (256 * 256), alpha / 255.0, 0.01) << alpha;
    // The item pass makes the same items; clay is opaque in both.
    renderer_->drawItems(*target_, mesh, planeCamera(), kAroundPlane);
    EXPECT_EQ(itemsNow(), items);
    DrawStyle clay;
    clay.colours = false;
    drawn(mesh, planeCamera(), kAroundPlane, clay);
    const std::vector<uint32_t> whole = itemsNow();
    EXPECT_EQ(std::count(whole.begin(), whole.end(), 0U), 0);
    if (alpha == 128) keep(picture, "translucent");
  }
}

TEST_F(DrawingStyles, ASplitSlidesToItsPlace) {
  const GridShape shape = planeShape(8);
  GpuMesh mesh(shape.quantization);
  MeshUpdate update = wholeUpdateOf(shape);
  // The right half of the vertices comes from the middle.
  const int32_t middle = shape.positions[4][0];
  for (size_t v = 0; v < update.vertices.size(); ++v) {
    if (update.vertices[v].position[0] <= middle) continue;
    update.vertices[v].from = {middle, update.vertices[v].position[1], 0};
    update.born.push_back(static_cast<uint32_t>(v));
  }
  ASSERT_TRUE(mesh.apply(update, 100));
  DrawStyle sliding;
  sliding.slideSeconds = 0.2F;
  EXPECT_NEAR(slidesUntil(std::array{MeshInstance{&mesh}}, sliding.slideSeconds), 100.2, 1e-6);
  const auto columns = [&](double now, bool wireframe = false) {
    FrameState frame;
    frame.now = now;
    sliding.wireframe = wireframe;
    const Picture picture = drawn(mesh, planeCamera(), kAroundPlane, sliding, frame);
    const std::vector<uint32_t> items = itemsNow();
    renderer_->drawItems(*target_, std::array{MeshInstance{&mesh}}, planeCamera(), kAroundPlane,
                         sliding, frame);
    EXPECT_EQ(itemsNow(), items);
    if (wireframe) keep(picture, "sliding");
    return 256 - std::count(items.begin() + 256 * 100, items.begin() + 256 * 101, 0U);
  };
  EXPECT_NEAR(columns(100), 128, 2);
  EXPECT_NEAR(columns(100.1), 192, 2);
  EXPECT_NEAR(columns(100.1, true), 192, 2);
  EXPECT_GT(columns(100.15), 200);
  EXPECT_EQ(columns(100.3), 256);
  // Over, or not asked for: the plain picture.
  FrameState during;
  during.now = 100.05;
  const Picture plain = drawn(mesh, planeCamera(), kAroundPlane, {}, during);
  during.now = 200;
  sliding.wireframe = false;
  EXPECT_EQ(drawn(mesh, planeCamera(), kAroundPlane, sliding, during), plain);
}

TEST_F(DrawingStyles, CirclesStandWhereSomethingIsMissing) {
  const GridShape shape = sphereShape(4, 0.15);
  GpuMesh mesh(shape.quantization, false);
  MeshUpdate update = withScales(shape);
  const size_t leaves = static_cast<size_t>(
      std::count_if(update.vertices.begin(), update.vertices.end(),
                    [](const DrawnVertex& vertex) { return vertex.isLeaf != 0; }));
  ASSERT_GT(leaves, 100U);
  ASSERT_TRUE(mesh.apply(update));
  const Camera camera = placeCamera(CameraSpec{}, kAroundSphere, 1);
  auto missing = MissingBounds::create();
  ASSERT_TRUE(missing) << missing.error().message;
  const std::array<MeshInstance, 1> scene = {MeshInstance{&mesh}};
  PixelBuffers pixels;
  const auto shown = [&](const std::vector<uint32_t>& counts, float radius) {
    EXPECT_TRUE(pixels.set(std::span(&counts, 1)));
    drawn(mesh, camera, kAroundSphere, {});
    const std::vector<uint32_t> items = itemsNow();
    LevelRadii radii{};
    for (size_t level = 0; level < radii.size(); ++level)
      radii.at(level) = radius * std::pow(0.9F, static_cast<float>(level));
    missing->draw(*target_, scene, std::span(&radii, 1), pixels, camera, kAroundSphere, 20);
    EXPECT_EQ(itemsNow(), items);
    return target_->readPicture();
  };
  const Picture plain = drawn(mesh, camera, kAroundSphere, {});
  const std::vector<uint32_t> all(mesh.vertexCount(), 5);
  EXPECT_EQ(shown(std::vector<uint32_t>(mesh.vertexCount(), 0), 0.05F), plain);
  EXPECT_EQ(shown(all, 1e-6F), plain);  // too small to be seen
  const Picture circles = shown(all, 0.05F);
  EXPECT_LT(peakSignalToNoise(circles, plain).value(), 40);
  keep(circles, "missing_bounds");
  // Around one vertex: a circle of the size that the projection says.
  std::vector<uint32_t> one(mesh.vertexCount(), 0);
  size_t chosen = 0;
  for (size_t v = 0; v < update.vertices.size(); ++v)
    if (update.vertices[v].isLeaf == 0) chosen = v;
  one[chosen] = 1;
  const Picture single = shown(one, 0.2F);
  const double world = 0.2 * std::pow(0.9, update.vertices[chosen].level);
  const std::array<double, 3> place = shape.quantization.toWorld(shape.positions[chosen]);
  const glm::dvec3 at(place[0], place[1], place[2]);
  const double distance = glm::dot(at - camera.eye, viewAxes(camera).forward);
  const double expected = world * 128 / std::tan(0.5 * camera.verticalFov) / distance;
  int low = 256;
  int high = -1;
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 256; ++x) {
      const auto pixel = 3 * (static_cast<size_t>(y) * 256 + static_cast<size_t>(x));
      if (single.rgb[pixel] == plain.rgb[pixel] && single.rgb[pixel + 1] == plain.rgb[pixel + 1])
        continue;
      low = std::min(low, x);
      high = std::max(high, x);
    }
  EXPECT_NEAR(high - low, 2 * expected, 3);
}

TEST_F(DrawingStyles, NormalsThatAMeshCarriesShadeIt) {
  const GridShape shape = sphereShape(3);
  const Camera camera = placeCamera(CameraSpec{}, kAroundSphere, 1);
  MeshArrays arrays{shape.quantization, shape.positions, shape.triangles, 1};
  const auto pictureOf = [&] {
    GpuMesh mesh;
    EXPECT_TRUE(mesh.update(arrays));
    return drawn(mesh, camera, kAroundSphere, {});
  };
  const Picture byTriangles = pictureOf();
  std::vector<std::array<float, 3>> outward;
  for (const GridPosition& position : shape.positions) {
    const std::array<double, 3> at = shape.quantization.toWorld(position);
    outward.push_back(
        {static_cast<float>(at[0]), static_cast<float>(at[1]), static_cast<float>(at[2])});
  }
  arrays.normalBits = 12;
  const auto carried = packAttributes({}, outward, {false, 12});
  arrays.normals = carried;
  EXPECT_GT(peakSignalToNoise(pictureOf(), byTriangles).value(), 40);
  const std::vector<std::array<float, 3>> upward(outward.size(), {0, 1, 0});
  const auto other = packAttributes({}, upward, {false, 12});
  arrays.normals = other;
  EXPECT_LT(peakSignalToNoise(pictureOf(), byTriangles).value(), 30);
  arrays.normals = std::span(other).first(5);
  GpuMesh mesh;
  EXPECT_FALSE(mesh.update(arrays));
}

TEST_F(DrawingStyles, PicksTheFaceTheVertexAndThePoint) {
  const GridShape shape = planeShape(4);
  MeshUpdate update = wholeUpdateOf(shape);
  GpuMesh mesh(shape.quantization);
  ASSERT_TRUE(mesh.apply(update));
  const GpuMesh empty;
  const glm::dvec3 place(500'000, 4'600'000, 10);
  const std::array<MeshInstance, 2> scene = {
      MeshInstance{&empty}, MeshInstance{&mesh, glm::translate(glm::dmat4(1), place)}};
  Camera camera = planeCamera();
  camera.eye += place;
  camera.target += place;
  const Bounds bounds{place, place + glm::dvec3(1, 1, 0)};
  renderer_->draw(*target_, scene, camera, bounds, {});
  // The pixel's centre is at (0.3027, 0.7910) of the square.
  const auto picked = pick(*target_, scene, camera, bounds, 77, 53);
  ASSERT_TRUE(picked);
  EXPECT_EQ(picked->instance, 1U);
  EXPECT_EQ(picked->face, 2U * (3 * 4 + 1));
  EXPECT_EQ(picked->slots, shape.triangles[picked->face]);
  EXPECT_NEAR(picked->world.x - place.x, 77.5 / 256, 1e-4);
  EXPECT_NEAR(picked->world.y - place.y, 1 - 53.5 / 256, 1e-4);
  EXPECT_NEAR(picked->world.z, place.z, 1e-4);
  EXPECT_EQ(picked->vertex.node, 3U * 5 + 1);  // at (0.25, 0.75)
  EXPECT_EQ(picked->slots.at(picked->nearest), 16U);
  EXPECT_FALSE(pick(*target_, scene, camera, bounds, -1, 50));
  EXPECT_FALSE(pick(*target_, scene, camera, bounds, 256, 50));
  camera.eye.x += 10;
  camera.target.x += 10;
  renderer_->draw(*target_, scene, camera, bounds, {});
  EXPECT_FALSE(pick(*target_, scene, camera, bounds, 77, 53));
}

TEST_F(DrawingStyles, LowerResolutionRanksNearlyTheSame) {
  const GridShape shape = sphereShape(4, 0.2);
  GpuMesh mesh(shape.quantization);
  ASSERT_TRUE(mesh.apply(wholeUpdateOf(shape)));
  const std::array<MeshInstance, 1> scene = {MeshInstance{&mesh}};
  RankingView view;
  view.camera = placeCamera(CameraSpec{}, kAroundSphere, 1.7);
  view.bounds = kAroundSphere;
  view.size = {510, 301};
  for (const auto method : {PixelCounter::Method::compute, PixelCounter::Method::readBack}) {
    auto ranking = RankingPass::create(method);
    ASSERT_TRUE(ranking) << ranking.error().message;
    std::vector<double> whole;
    for (const int divisor : {1, 2, 4}) {
      view.divisor = divisor;
      const auto started = ranking->start(*renderer_, scene, view, static_cast<uint64_t>(divisor));
      ASSERT_TRUE(started) << started.error().message;
      ASSERT_TRUE(*started);
      PixelCounts counts;
      for (int i = 0; i < 10'000 && !ranking->take(counts); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      ASSERT_EQ(counts.pixels.size(), 1U);
      EXPECT_EQ(counts.tag, static_cast<uint64_t>(divisor));
      const std::vector<double> pixels(counts.pixels[0].begin(), counts.pixels[0].end());
      if (divisor == 1) whole = pixels;
      double apart = 0;
      for (size_t v = 0; v < pixels.size(); ++v) apart += std::abs(pixels[v] - whole[v]);
      const double sum = std::accumulate(whole.begin(), whole.end(), 0.0);
      EXPECT_NEAR(std::accumulate(pixels.begin(), pixels.end(), 0.0), sum, 0.02 * sum);
      EXPECT_LE(apart, 0.13 * divisor / 2 * (divisor - 1) * sum) << divisor;
    }
    view.divisor = 3;
    EXPECT_FALSE(ranking->start(*renderer_, scene, view));
  }
}

}  // namespace
}  // namespace meshfront
