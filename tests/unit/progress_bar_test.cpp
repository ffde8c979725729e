#include "encoder/pipeline/progress_bar.h"

#include <gtest/gtest.h>

#include <vector>

#include "encoder/pipeline/encode_mesh.h"
#include "tests/data/fractal_sphere.h"
#include "tests/data/temporary_folder.h"

namespace meshfront {
namespace {

TEST(ProgressBar, TellsPhaseShareAndTimeLeft) {
  EXPECT_EQ(progressLine("simplify", 0.5, 30),
            "simplify   [===============               ]  50 %, about 30 s left");
  EXPECT_EQ(progressLine("code", 0.25, 30),
            "code       [=======                       ]  25 %, about 1:30 min left");
  EXPECT_EQ(progressLine("read", 0.01, 3), "read       [                              ]   1 %");
  EXPECT_EQ(progressLine("write", 7, 3),
            "write      [==============================] 100 %, about 0 s left");
}

TEST(ProgressBar, OnlyMovesForward) {
  const TemporaryFolder folder;
  ASSERT_TRUE(writeFractalSphere(folder / "a.ply", FractalSphere(60000, 1)));
  std::vector<double> shares;
  ASSERT_TRUE(encodeFile(
      folder / "a.ply", {.name = "a"},
      [&](const std::string& phase, double done) { shares.push_back(overallShare(phase, done)); }));
  EXPECT_GT(shares.size(), 10U);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_GE(shares.front(), 0);
  EXPECT_GT(overallShare("write", 0), shares.back());
  EXPECT_NEAR(overallShare("write", 1), 1, 1e-9);
}

TEST(Encoding, GivesTheSameRevisionOnAnyNumberOfThreads) {
  IndexedMesh mesh;
  const FractalSphere sphere(60000, 1);
  sphere.forEachVertex([&](const auto& p) { mesh.positions.push_back(p); });
  sphere.forEachTriangle([&](const Triangle& t) { mesh.triangles.push_back(t); });
  std::string revision;
  for (const unsigned threads : {1U, 2U, 5U}) {
    EncodeOptions options{.name = "a"};
    options.threads = threads;
    const std::string found = revisionOf(encodeMesh(mesh, options).value().pack);
    if (revision.empty()) revision = found;
    EXPECT_EQ(found, revision) << threads << " threads";
  }
}

}  // namespace
}  // namespace meshfront
