#include "tests/bench/bench_mesh.h"

#include <ctime>

#include "shared/mesh_files/mesh_files.h"

namespace meshfront {

Result<BenchMesh> readBenchMesh(const std::string& path, unsigned bits) {
  auto read = readMesh(path);
  if (!read) return tl::unexpected(read.error());
  CleaningReport cleaning;
  auto closed = closeMesh(*read, cleaning);
  if (!closed) return fail(path + ": " + closed.error().message);
  BenchMesh mesh;
  const Quantization grid = quantizationFor(closed->positions, bits);
  for (const auto& p : closed->positions) mesh.positions.push_back(grid.toGrid(p));
  closed->positions.clear();
  mesh.closed = std::move(*closed);
  return mesh;
}

double processorSeconds() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

size_t countVertices(std::span<const Triangle> triangles) {
  std::vector<bool> seen;
  size_t count = 0;
  for (const Triangle& t : triangles) {
    for (const uint32_t v : t) {
      if (v >= seen.size()) seen.resize(v + 1);
      count += static_cast<size_t>(!seen[v]);
      seen[v] = true;
    }
  }
  return count;
}

}  // namespace meshfront
