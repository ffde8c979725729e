// Collapses a second of our simplifier, of OpenMesh's decimater (quadrics alone) and of
// meshoptimizer's, side by side on the same cleaned mesh and down to the same size. Runs are
// interleaved; medians are told.
//
//   simplification-bench bunny.ply igea.ply
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "encoder/simplification/simplify.h"
#include "tests/bench/bench_mesh.h"
#include "tests/bench/peer_simplifiers.h"

namespace meshfront {
namespace {

struct Contender {
  const char* name;
  std::vector<double> seconds;
  size_t vertices = 0;  // left

  [[nodiscard]] double median() {
    std::sort(seconds.begin(), seconds.end());
    return seconds[seconds.size() / 2];
  }
};

int bench(const std::string& path, unsigned bits, const SimplifyOptions& options, unsigned runs) {
  const Result<BenchMesh> mesh = readBenchMesh(path, bits);
  if (!mesh) {
    std::fprintf(stderr, "simplification-bench: %s\n", mesh.error().message.c_str());
    return 1;
  }
  std::vector<Contender> contenders = {{"meshfront", {}}, {"OpenMesh", {}}, {"meshoptimizer", {}}};
  unsigned tallest = 0;
  for (unsigned run = 0; run < runs; ++run) {
    const double start = processorSeconds();
    const Simplification ours =
        simplify(mesh->positions, mesh->closed.virtualCount, mesh->closed.triangles,
                 mesh->closed.realTriangleCount, options);
    contenders[0].seconds.push_back(processorSeconds() - start);
    contenders[0].vertices = ours.report.baseVertices;
    tallest = ours.report.maxHeight;
    const Simplified open = openMeshDecimated(*mesh, ours.report.baseVertices);
    contenders[1].seconds.push_back(open.seconds);
    contenders[1].vertices = countVertices(open.triangles);
    const Simplified meshopt = meshoptSimplified(*mesh, 2 * size_t{ours.report.baseVertices});
    contenders[2].seconds.push_back(meshopt.seconds);
    contenders[2].vertices = countVertices(meshopt.triangles);
  }
  std::printf("%s: %zu vertices, tallest tree %u\n", path.c_str(), mesh->positions.size(), tallest);
  const auto rate = [&](Contender& c) {
    return static_cast<double>(mesh->positions.size() - c.vertices) / c.median();
  };
  const double ours = rate(contenders[0]);
  for (Contender& c : contenders) {
    std::printf("  %-13s down to %7zu vertices  %8.3f s  %9.0f collapses/s  ours/this %5.2f\n",
                c.name, c.vertices, c.median(), rate(c), ours / rate(c));
  }
  return 0;
}

}  // namespace
}  // namespace meshfront

int main(int argc, char** argv) {
  try {
    CLI::App app("Times mesh simplification: ours beside OpenMesh's decimater and meshoptimizer's");
    std::vector<std::string> paths;
    unsigned bits = meshfront::kDefaultQuantizationBits;
    unsigned runs = 3;
    meshfront::SimplifyOptions options;
    app.add_option("meshes", paths, "Mesh files")->required();
    app.add_option("--quantization", bits, "Bits a coordinate")
        ->capture_default_str()
        ->check(CLI::Range(meshfront::kMinQuantizationBits, meshfront::kMaxQuantizationBits));
    app.add_option("--base-fraction", options.baseFraction, "Base size, share of the vertices")
        ->capture_default_str()
        ->check(CLI::Range(0.0, 1.0));
    app.add_option("--balance", options.balance, "Power of the tree height in the cost")
        ->capture_default_str()
        ->check(CLI::Range(0, 2));
    app.add_option("--runs", runs, "Runs of each, interleaved; the median is told")
        ->capture_default_str()
        ->check(CLI::Range(1, 100));
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? 0 : 2;
    }
    int result = 0;
    for (const std::string& path : paths) result |= meshfront::bench(path, bits, options, runs);
    return result;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "simplification-bench: %s\n", error.what());
    return 1;
  }
}
