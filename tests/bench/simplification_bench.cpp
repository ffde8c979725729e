// Collapses a second of our simplifier and of OpenMesh's decimater (ModQuadric alone), side by side
// on the same cleaned mesh and down to the same number of vertices.
//
//   simplification-bench bunny.ply igea.ply
#include <CLI/CLI.hpp>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <cstdio>
#include <ctime>
#include <exception>
#include <string>
#include <vector>

#include "encoder/cleaning/close_mesh.h"
#include "encoder/simplification/simplify.h"
#include "shared/mesh/quantization.h"
#include "shared/mesh_files/mesh_files.h"

namespace meshfront {
namespace {

struct Run {
  size_t collapses = 0;
  double seconds = 0;
  [[nodiscard]] double perSecond() const {
    return seconds > 0 ? static_cast<double>(collapses) / seconds : 0;
  }
};

// Processor time, which neighbours on the machine disturb less than they do the clock.
double processorSeconds() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

// Building the mesh is counted for both.
Run runOpenMesh(const ClosedMesh& mesh, const std::vector<GridPosition>& positions,
                size_t collapses) {
  using Mesh = OpenMesh::TriMesh_ArrayKernelT<>;
  const double start = processorSeconds();
  Mesh open;
  for (const GridPosition& p : positions) {
    open.add_vertex(
        Mesh::Point(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])));
  }
  for (size_t i = 0; i < mesh.realTriangleCount; ++i) {
    std::vector<Mesh::VertexHandle> corners;
    for (const uint32_t v : mesh.triangles[i]) corners.emplace_back(static_cast<int>(v));
    open.add_face(corners);
  }
  OpenMesh::Decimater::DecimaterT<Mesh> decimater(open);
  OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
  decimater.add(quadric);
  decimater.module(quadric).unset_max_err();
  decimater.initialize();
  const size_t done = decimater.decimate(collapses);
  return {done, processorSeconds() - start};
}

int bench(const std::string& path, unsigned bits, const SimplifyOptions& options) {
  const Result<IndexedMesh> read = readMesh(path);
  CleaningReport cleaning;
  const Result<ClosedMesh> mesh = read ? closeMesh(*read, cleaning) : fail(read.error().message);
  if (!mesh) {
    std::fprintf(stderr, "simplification-bench: %s\n", mesh.error().message.c_str());
    return 1;
  }
  const Quantization grid = quantizationFor(mesh->positions, bits);
  std::vector<GridPosition> positions;
  positions.reserve(mesh->positions.size());
  for (const auto& p : mesh->positions) positions.push_back(grid.toGrid(p));

  const double start = processorSeconds();
  const Simplification result =
      simplify(positions, mesh->virtualCount, mesh->triangles, mesh->realTriangleCount, options);
  const Run ours = {result.collapses.size(), processorSeconds() - start};
  const Run theirs = runOpenMesh(*mesh, positions, result.collapses.size());
  std::printf("%s: %zu vertices, base %u, tallest tree %u\n", path.c_str(), positions.size(),
              result.report.baseVertices, result.report.maxHeight);
  for (const auto& [name, run] : {std::pair{"meshfront", ours}, std::pair{"OpenMesh ", theirs}}) {
    std::printf("  %s %9zu collapses %8.3f s %9.0f collapses/s\n", name, run.collapses, run.seconds,
                run.perSecond());
  }
  return 0;
}

}  // namespace
}  // namespace meshfront

int main(int argc, char** argv) {
  try {
    CLI::App app("Times mesh simplification: ours beside OpenMesh's decimater");
    std::vector<std::string> paths;
    unsigned bits = meshfront::kDefaultQuantizationBits;
    meshfront::SimplifyOptions options;
    app.add_option("meshes", paths, "Mesh files (PLY, OBJ, STL, OFF)")->required();
    app.add_option("--quantization", bits, "Bits a coordinate")
        ->capture_default_str()
        ->check(CLI::Range(meshfront::kMinQuantizationBits, meshfront::kMaxQuantizationBits));
    app.add_option("--base-fraction", options.baseFraction, "Base size, share of the vertices")
        ->capture_default_str()
        ->check(CLI::Range(0.0, 1.0));
    app.add_option("--balance", options.balance, "Power of the tree height in the cost")
        ->capture_default_str()
        ->check(CLI::Range(0, 2));
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? 0 : 2;
    }
    int result = 0;
    for (const std::string& path : paths) result |= meshfront::bench(path, bits, options);
    return result;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "simplification-bench: %s\n", error.what());
    return 1;
  }
}
