#include "encoder/pipeline/base_advice.h"

#include <gtest/gtest.h>

#include "encoder/pipeline/encode_mesh.h"
#include "tests/data/mesh_shapes.h"

namespace meshfront {
namespace {

bool says(const std::vector<std::string>& advice, const std::string& words) {
  for (const std::string& sentence : advice)
    if (sentence.find(words) != std::string::npos) return true;
  return false;
}

std::vector<std::string> adviceFor(IndexedMesh mesh, const EncodeOptions& options) {
  const auto encoded = encodeMesh(std::move(mesh), options).value();
  auto advice = adviceOnBase(encoded.report.simplification, encoded.pack.metadata.vertexCount);
  for (const std::string& sentence : advice)  // both reports say the same
    EXPECT_NE(describe(encoded.report).find(sentence), std::string::npos);
  EXPECT_EQ(toJson(encoded.report, false).find("\"advice\": []") != std::string::npos,
            advice.empty());
  return advice;
}

TEST(BaseAdvice, IsSilentIfAllWentWell) {
  EXPECT_TRUE(adviceFor(sphere(5), {.name = "sphere"}).empty());
  EXPECT_TRUE(adviceFor(tetrahedron(), {.name = "smallest"}).empty());
}

TEST(BaseAdvice, NamesTheOptionThatAskedForALargeBase) {
  EXPECT_TRUE(says(adviceFor(sphere(4), {.name = "s", .baseFraction = 0.1}), "--base-fraction"));
}

TEST(BaseAdvice, NamesTopologyWhereItIsTheBound) {
  IndexedMesh mesh;
  for (int i = 0; i < 30; ++i) appendMesh(mesh, sphere(1), {3.0 * i, 0, 0});
  const auto advice = adviceFor(std::move(mesh), {.name = "parts"});
  EXPECT_TRUE(says(advice, "120 vertices (22.2 %) instead of 4"));
  EXPECT_TRUE(says(advice, "30 components, 30 of them down to 4 vertices"));
  EXPECT_FALSE(says(advice, "--"));
}

TEST(BaseAdvice, NamesTheOptionThatRelaxesARule) {
  EncodeOptions options{.name = "torus"};
  options.maxValence = 5;
  EXPECT_TRUE(says(adviceFor(torus(24, 12), options), "--max-valence 6"));

  SimplifyReport report;
  report.why = StopReason::noValidCollapse;
  report.baseVertices = 50;
  report.endState.depthAlone = 3;
  EXPECT_TRUE(says(adviceOnBase(report, 1000), "--balance 2"));
  report.endState = {};
  report.endState.valenceAlone = 3;
  report.endState.valenceNeeded = kLargestMaxValence + 1;
  EXPECT_TRUE(says(adviceOnBase(report, 1000), "split such hubs"));
}

}  // namespace
}  // namespace meshfront
