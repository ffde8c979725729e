#include "encoder/pipeline/memory_estimate.h"

#include <gtest/gtest.h>

#include <fstream>

#include "encoder/pipeline/encode_mesh.h"
#include "shared/mesh_files/available_memory.h"
#include "shared/mesh_files/mesh_files.h"
#include "tests/data/fractal_sphere.h"
#include "tests/data/mesh_shapes.h"
#include "tests/data/temporary_folder.h"

namespace meshfront {
namespace {

namespace fs = std::filesystem;
constexpr uint64_t kMebi = uint64_t{1} << 20;

void put(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

TEST(MemoryEstimate, IsTheLargestPhase) {
  const MemoryEstimate scan = estimateMemory({1000000, 2000000}, 38000000);
  EXPECT_EQ(scan.peak(), scan.simplify);
  EXPECT_NEAR(static_cast<double>(scan.peak()), 240e6, 20e6);
  EXPECT_EQ(estimateMemory({1000, 2000}, uint64_t{1} << 40).peak(),
            estimateMemory({1000, 2000}, uint64_t{1} << 40).read);
  // Corners that are yet to be welded cost more than vertices.
  EXPECT_GT(estimateMemory({6000000, 2000000}, 0).peak(), scan.peak());
  // Beyond 32 bits.
  EXPECT_GT(estimateMemory({uint64_t{1} << 30, uint64_t{1} << 31}, 0).peak(), uint64_t{200} << 30);
}

TEST(MemoryEstimate, CountsColoursAndNormals) {
  const MeshSize plain{1000000, 2000000};
  MeshSize full = plain;
  full.colours = full.normals = true;
  const MemoryEstimate before = estimateMemory(plain, 0);
  const MemoryEstimate after = estimateMemory(full, 0);
  EXPECT_EQ(after.read - before.read, 16000000U);
  EXPECT_EQ(after.clean - before.clean, 16000000U);
  EXPECT_EQ(after.simplify - before.simplify, 8000000U);
  EXPECT_EQ(after.code - before.code, 8000000U);
}

TEST(MemoryEstimate, ReadsOfAttributesInAPly) {
  const TemporaryFolder folder;
  put(folder / "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 0\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0 0 0 1 9 9 9\n");
  const auto size = promisedSize(folder / "a.ply");
  ASSERT_TRUE(size);
  EXPECT_TRUE(size->colours);
  EXPECT_TRUE(size->normals);
}

TEST(MemoryEstimate, ReadsWhatAPlyPromises) {
  const TemporaryFolder folder;
  const FractalSphere sphere(5000, 1);
  ASSERT_TRUE(writeFractalSphere(folder / "a.ply", sphere));
  const auto size = promisedSize(folder / "a.ply");
  ASSERT_TRUE(size);
  EXPECT_EQ(size->vertices, sphere.vertexCount());
  EXPECT_EQ(size->triangles, sphere.triangleCount());
}

TEST(MemoryEstimate, DoesNotBelieveMoreThanTheFileCanHold) {
  const TemporaryFolder folder;
  put(folder / "big.ply",
      "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000000000\nproperty float x\n"
      "property float y\nproperty float z\nelement face 18446744073709551615\n"
      "property list uchar int vertex_indices\nend_header\n" +
          std::string(1200, '\0'));
  const auto size = promisedSize(folder / "big.ply");
  ASSERT_TRUE(size);
  EXPECT_LE(size->vertices, 200U);
  EXPECT_LE(size->triangles, 2000U);
  put(folder / "broken.ply", "ply\nformat");
  EXPECT_FALSE(promisedSize(folder / "broken.ply"));
  EXPECT_FALSE(promisedSize(folder / "absent.ply"));
  EXPECT_FALSE(promisedSize(folder.path()));
}

TEST(MemoryEstimate, ReadsWhatABinaryStlPromises) {
  const TemporaryFolder folder;
  put(folder / "a.stl",
      std::string(80, ' ') + std::string("\x03\0\0\0", 4) + std::string(150, '\0'));
  const auto size = promisedSize(folder / "a.stl");
  ASSERT_TRUE(size);
  EXPECT_EQ(size->triangles, 3U);
  put(folder / "b.stl", "solid of text\nfacet normal 0 0 1\n");
  EXPECT_FALSE(promisedSize(folder / "b.stl"));
}

TEST(MemoryEstimate, RefusesBeforeAndAfterReading) {
  const TemporaryFolder folder;
  ASSERT_TRUE(writeFractalSphere(folder / "a.ply", FractalSphere(20000, 1)));
  EncodeOptions options{.name = "a"};
  options.memoryLimit = 9 * kMebi;
  options.memoryLimitedBy = "the test";
  std::vector<std::string> phases;
  const auto fromFile =
      encodeFile(folder / "a.ply", options,
                 [&](const std::string& phase, double) { phases.push_back(phase); });
  ASSERT_FALSE(fromFile);
  EXPECT_EQ(fromFile.error().code, ErrorCode::tooLarge);
  for (const char* part : {"a.ply", "MiB", "the test", "--memory-limit", "20252 vertices"})
    EXPECT_NE(fromFile.error().message.find(part), std::string::npos) << part;
  EXPECT_EQ(phases, std::vector<std::string>{"read"});
  EXPECT_FALSE(encodeMesh(sphere(7), options));
  options.memoryLimit = 100 * kMebi;
  EXPECT_TRUE(encodeFile(folder / "a.ply", options));
}

// A machine with 8000 MiB available.
void putMachine(const TemporaryFolder& root) {
  put(root / "proc/meminfo", "MemTotal:       9999999 kB\nMemAvailable:    8192000 kB\n");
}

TEST(AvailableMemory, IsTheMachinesIfNothingElseLimits) {
  const TemporaryFolder root;
  EXPECT_EQ(availableMemory(root.path()).bytes, UINT64_MAX);
  putMachine(root);
  EXPECT_EQ(availableMemory(root.path()).bytes, 8000 * kMebi);
  put(root / "proc/self/cgroup", "0::/\n");
  put(root / "sys/fs/cgroup/memory.max", "max\n");
  put(root / "sys/fs/cgroup/memory.current", "1048576\n");
  EXPECT_EQ(availableMemory(root.path()).bytes, 8000 * kMebi);
  EXPECT_GT(availableMemory().bytes, 100 * kMebi);  // here and now
}

TEST(AvailableMemory, KeepsToGroupsOfVersion2AndTheirParents) {
  const TemporaryFolder root;
  putMachine(root);
  put(root / "proc/self/cgroup", "0::/outer/inner\n");
  put(root / "sys/fs/cgroup/outer/inner/memory.max", std::to_string(900 * kMebi));
  put(root / "sys/fs/cgroup/outer/inner/memory.current", std::to_string(300 * kMebi));
  put(root / "sys/fs/cgroup/outer/inner/memory.stat",
      "anon 5\ninactive_file " + std::to_string(100 * kMebi) + "\n");
  EXPECT_EQ(availableMemory(root.path()).bytes, 700 * kMebi);
  put(root / "sys/fs/cgroup/outer/memory.max", std::to_string(800 * kMebi));
  put(root / "sys/fs/cgroup/outer/memory.current", std::to_string(650 * kMebi));
  EXPECT_EQ(availableMemory(root.path()).bytes, 150 * kMebi);
  EXPECT_NE(availableMemory(root.path()).limitedBy.find("control group"), std::string::npos);
  put(root / "sys/fs/cgroup/outer/memory.current", std::to_string(850 * kMebi));
  EXPECT_EQ(availableMemory(root.path()).bytes, 0U);
}

TEST(AvailableMemory, KeepsToGroupsOfVersion1) {
  const TemporaryFolder root;
  putMachine(root);
  put(root / "proc/self/cgroup", "5:cpu,cpuacct:/\n4:memory:/not/mounted/here\n0::/\n");
  put(root / "sys/fs/cgroup/memory/memory.limit_in_bytes", std::to_string(500 * kMebi));
  put(root / "sys/fs/cgroup/memory/memory.usage_in_bytes", std::to_string(450 * kMebi));
  put(root / "sys/fs/cgroup/memory/memory.stat",
      "inactive_file 7\ntotal_inactive_file " + std::to_string(50 * kMebi) + "\n");
  EXPECT_EQ(availableMemory(root.path()).bytes, 100 * kMebi);
  put(root / "sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712");  // none
  EXPECT_EQ(availableMemory(root.path()).bytes, 8000 * kMebi);
}

}  // namespace
}  // namespace meshfront
