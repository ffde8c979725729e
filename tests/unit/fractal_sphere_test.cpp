#include "tests/data/fractal_sphere.h"

#include <gtest/gtest.h>

#include "encoder/cleaning/close_mesh.h"
#include "shared/bits/crc32c.h"
#include "shared/mesh_files/file_bytes.h"
#include "shared/mesh_files/mesh_files.h"
#include "tests/data/closed_manifold_check.h"
#include "tests/data/temporary_folder.h"

namespace meshfront {
namespace {

TEST(FractalSphere, IsClosedAtEverySize) {
  for (const uint64_t vertices : {12U, 13U, 43U, 90U, 1000U, 20000U}) {
    const FractalSphere sphere(vertices, 7);
    EXPECT_GE(sphere.vertexCount(), vertices);
    IndexedMesh mesh;
    sphere.forEachVertex([&](const auto& p) { mesh.positions.push_back(p); });
    sphere.forEachTriangle([&](const Triangle& t) { mesh.triangles.push_back(t); });
    ASSERT_EQ(mesh.positions.size(), sphere.vertexCount());
    ASSERT_EQ(mesh.triangles.size(), sphere.triangleCount());
    EXPECT_EQ(whyNotClosedManifold(mesh.positions.size(), mesh.triangles), "");
    CleaningReport report;
    ASSERT_TRUE(closeMesh(mesh, report));
    EXPECT_EQ(report.components, 1U);
    EXPECT_EQ(report.weldedVertices + report.boundaryLoops + report.verticesSplit, 0U);
    double volume = 0;  // six times; positive if the faces look out
    for (const Triangle& t : mesh.triangles) {
      const auto& a = mesh.positions[t[0]];
      const auto& b = mesh.positions[t[1]];
      const auto& c = mesh.positions[t[2]];
      volume += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    EXPECT_GT(volume, 6);
  }
}

TEST(FractalSphere, IsTheSameOnEveryMachine) {
  const TemporaryFolder folder;
  const auto checksum = [&](uint64_t seed) {
    const auto path = folder.path() / "sphere.ply";
    EXPECT_TRUE(writeFractalSphere(path, FractalSphere(5000, seed)));
    EXPECT_EQ(readMesh(path)->positions.size(), FractalSphere(5000, seed).vertexCount());
    const std::string bytes = readFileBytes(path).value();
    return crc32c({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()});
  };
  EXPECT_EQ(checksum(1), 3648932628U);
  EXPECT_NE(checksum(2), checksum(1));
}

TEST(FractalSphere, TellsWhichFileCannotBeWritten) {
  const auto missing = writeFractalSphere("/nowhere/at/all.ply", FractalSphere(1000, 1));
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("/nowhere/at/all.ply"), std::string::npos);
}

}  // namespace
}  // namespace meshfront
