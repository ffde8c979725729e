// Pixels estimated from projected triangles, against those that GL counts.
#include "load/projected_pixels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "shared/camera/camera_spec.h"
#include "shared/codec/chunk.h"
#include "tests/unit/mesh_service.h"
#include "viewer/gl/gl_context.h"
#include "viewer/gl/mesh_renderer.h"
#include "viewer/gl/pixel_counter.h"

namespace meshfront {
namespace {

struct RefinedTorus {
  SelectivelyRefinedMesh mesh;
  Quantization quantization;
  Bounds bounds = Bounds::of({0, 0, 0}, {16'000, 16'000, 16'000});
};

// With the records of the first bands.
RefinedTorus refinedTorus() {
  const TestMesh torus = TestMesh::torus(64, 32);
  RefinedTorus refined{*SelectivelyRefinedMesh::fromBase(*decodeBaseMesh(torus.coded.base)), {}};
  for (size_t i = 0; i < torus.coded.chunks.size() / 2; ++i) {
    const auto chunk = decodeChunk(torus.coded.chunks[i], refined.mesh.base().tables);
    for (const RecordEntry& entry : chunk->entries) {
      const auto node = refined.mesh.find(entry.id);
      if (!node || !refined.mesh.isActive(*node)) continue;
      EXPECT_TRUE(
          refined.mesh.split(*node, torus.coded.chunks[i], entry.bitOffset, entry.bitLength));
    }
  }
  return refined;
}

Camera cameraAt(const RefinedTorus& torus, const std::string& spec) {
  return placeCamera(*parseCameraSpec(spec), torus.bounds, 1);
}

// Spearman's: 1 = the same order.
double rankCorrelation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto ranks = [](const std::vector<double>& values) {
    std::vector<size_t> order(values.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t x, size_t y) { return values[x] < values[y]; });
    std::vector<double> rank(values.size());
    for (size_t begin = 0; begin < order.size();) {
      size_t end = begin;
      while (end < order.size() && values[order[end]] == values[order[begin]]) ++end;
      for (size_t i = begin; i < end; ++i)
        rank[order[i]] = 0.5 * static_cast<double>(begin + end - 1);
      begin = end;
    }
    return rank;
  };
  const std::vector<double> x = ranks(a);
  const std::vector<double> y = ranks(b);
  const double mean = 0.5 * static_cast<double>(a.size() - 1);
  double xy = 0;
  double xx = 0;
  double yy = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    xy += (x[i] - mean) * (y[i] - mean);
    xx += (x[i] - mean) * (x[i] - mean);
    yy += (y[i] - mean) * (y[i] - mean);
  }
  return xy / std::sqrt(xx * yy);
}

TEST(ProjectedPixels, RankAsDrawnPixelsDo) {
  const auto context = GlContext::createHeadless();
  ASSERT_TRUE(context) << context.error().message;
  const RefinedTorus torus = refinedTorus();
  for (const PixelSize size : {PixelSize{400, 400}, PixelSize{300, 200}}) {
    auto target = RenderTarget::create(size);
    const auto renderer = MeshRenderer::create();
    ASSERT_TRUE(target && renderer);
    GpuMesh gpuMesh;
    ASSERT_TRUE(gpuMesh.update({torus.quantization, torus.mesh.positions(),
                                torus.mesh.drawnCorners(), torus.mesh.changeCount()}));
    PixelCounter counter = PixelCounter::create(PixelCounter::Method::readBack);
    std::vector<uint32_t> drawn;
    ProjectedPixels projected;
    // From above its hole, little of a torus is hidden behind itself: it lies in the xy plane.
    for (const char* spec : {"eye=9000,8500,40000;up=y", "close;azimuth=5;elevation=5",
                             "zoom=5;target=13500,8000,9000;azimuth=20"}) {
      const Camera camera = cameraAt(torus, spec);
      renderer->drawItems(*target, gpuMesh, camera, torus.bounds);
      counter.count(*target, gpuMesh, drawn);
      const auto estimated =
          projected.count(torus.mesh, torus.quantization, torus.bounds, camera, size);
      ASSERT_EQ(estimated.size(), drawn.size());
      std::vector<double> seen;
      std::vector<double> guessed;
      size_t missed = 0;
      double drawnSum = 0;
      double estimatedSum = 0;
      for (size_t i = 0; i < drawn.size(); ++i) {
        estimatedSum += estimated[i];
        drawnSum += drawn[i];
        if (drawn[i] < 8) continue;  // a pixel more or less is chance
        seen.push_back(drawn[i]);
        guessed.push_back(estimated[i]);
        missed += estimated[i] == 0 ? 1 : 0;
      }
      ASSERT_GT(seen.size(), 20U) << spec;
      EXPECT_EQ(missed, 0U) << spec;
      EXPECT_GT(rankCorrelation(seen, guessed), 0.9) << spec;
      EXPECT_GT(estimatedSum, 0.9 * drawnSum) << spec;
      EXPECT_LT(estimatedSum, 2.5 * drawnSum) << spec;
    }
  }
}

TEST(ProjectedPixels, OutOfThePictureIsNothing) {
  const RefinedTorus torus = refinedTorus();
  ProjectedPixels projected;
  for (const char* spec : {"eye=8000,8000,40000;target=8000,8000,80000;up=y",   // looks away
                           "eye=90000,8000,40000;target=90000,8000,0;up=y"}) {  // looks past it
    const auto counts = projected.count(torus.mesh, torus.quantization, torus.bounds,
                                        cameraAt(torus, spec), {400, 400});
    EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), uint64_t{0}), 0U) << spec;
  }
  // From within, some triangles reach through the eye's plane.
  const auto within = projected.count(torus.mesh, torus.quantization, torus.bounds,
                                      cameraAt(torus, "eye=8000,8000,8000"), {400, 400});
  EXPECT_GT(std::accumulate(within.begin(), within.end(), uint64_t{0}), 0U);
}

}  // namespace
}  // namespace meshfront
