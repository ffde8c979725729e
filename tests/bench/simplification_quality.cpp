// How far simplified meshes are from the input: ours, OpenMesh's decimater's and meshoptimizer's at
// equal numbers of vertices, in both directions.
//
//   simplification-quality bunny.ply igea.ply
//
// Ours is the mesh of a receiver that splits in the order of significance, whatever it looks at:
// "rank" in the very order of collapses, "level" by the levels that records carry and in preorder
// within a level.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <numeric>
#include <string>
#include <vector>

#include "encoder/hierarchy/vertex_forest.h"
#include "encoder/simplification/simplify.h"
#include "tests/bench/bench_mesh.h"
#include "tests/bench/peer_simplifiers.h"
#include "tests/bench/surface_distance.h"

namespace meshfront {
namespace {

// The input's triangles after all collapses but those that are undone.
std::vector<Triangle> meshAfter(const BenchMesh& mesh, const std::vector<Collapse>& collapses,
                                const std::vector<bool>& undone) {
  std::vector<uint32_t> went(mesh.positions.size());
  std::iota(went.begin(), went.end(), 0U);
  for (size_t i = collapses.size(); i-- > 0;) {  // coarse first: what is kept has its place already
    if (!undone[i]) went[collapses[i].removed] = went[collapses[i].kept];
  }
  std::vector<Triangle> out;
  for (const Triangle& t : mesh.drawn()) {
    const Triangle moved = {went[t[0]], went[t[1]], went[t[2]]};
    if (moved[0] != moved[1] && moved[1] != moved[2] && moved[2] != moved[0]) out.push_back(moved);
  }
  return out;
}

std::vector<bool> firstByRank(size_t collapses, size_t splits) {
  std::vector<bool> undone(collapses);
  std::fill(undone.end() - static_cast<std::ptrdiff_t>(splits), undone.end(), true);
  return undone;
}

std::vector<bool> firstByLevel(const VertexForest& forest, size_t splits) {
  std::vector<ForestNode> order = forest.splitsInPreorder();
  std::stable_sort(order.begin(), order.end(),
                   [&](ForestNode a, ForestNode b) { return forest.level(a) < forest.level(b); });
  std::vector<bool> undone(order.size());
  for (size_t i = 0; i < splits; ++i) undone[order[i] - forest.leafCount()] = true;
  return undone;
}

struct Row {
  const char* name;
  size_t vertices = 0;
  SurfaceDistance there;  // from the input to the simplified mesh
  SurfaceDistance back;
  [[nodiscard]] double mean() const { return (there.mean + back.mean) / 2; }
};

std::vector<Point> pointsOf(const std::vector<GridPosition>& positions) {
  std::vector<Point> points;
  points.reserve(positions.size());
  for (const auto& [x, y, z] : positions) {
    points.push_back({static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)});
  }
  return points;
}

class Quality {
 public:
  Quality(const BenchMesh& mesh, size_t samples)
      : mesh_(mesh),
        positions_(pointsOf(mesh.positions)),
        samples_(samples),
        input_(positions_, mesh.drawn()) {
    Point low = positions_.front();
    Point high = low;
    for (const Point& p : positions_) {
      for (size_t i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], p[i]);
        high[i] = std::max(high[i], p[i]);
      }
    }
    diagonal_ = std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  }
  // Distances in millionths of the bounding box's diagonal.
  [[nodiscard]] Row measure(const char* name, const std::vector<Triangle>& triangles) const {
    const TriangleTree simplified(positions_, triangles);
    Row row{name, countVertices(triangles), {}, {}};
    row.there = surfaceDistance(positions_, mesh_.drawn(), simplified, samples_);
    row.back = surfaceDistance(positions_, triangles, input_, samples_);
    for (SurfaceDistance* d : {&row.there, &row.back}) {
      d->mean *= 1e6 / diagonal_;
      d->maximum *= 1e6 / diagonal_;
    }
    return row;
  }

 private:
  const BenchMesh& mesh_;
  std::vector<Point> positions_;
  size_t samples_;
  double diagonal_ = 1;
  TriangleTree input_;
};

int bench(const std::string& path, unsigned bits, SimplifyOptions options,
          const std::vector<double>& shares, size_t samples) {
  const Result<BenchMesh> mesh = readBenchMesh(path, bits);
  if (!mesh) {
    std::fprintf(stderr, "simplification-quality: %s\n", mesh.error().message.c_str());
    return 1;
  }
  const Simplification ours =
      simplify(mesh->positions, mesh->closed.virtualCount, mesh->closed.triangles,
               mesh->closed.realTriangleCount, options);
  const VertexForest forest(mesh->positions, mesh->closed.virtualCount, ours.collapses);
  const size_t all = mesh->positions.size();
  const Quality quality(*mesh, samples);
  std::printf("%s: %zu vertices; distances in millionths of the diagonal\n", path.c_str(), all);
  std::printf("  %-6s %-16s %8s  %9s %9s  %9s %9s  %9s  %s\n", "share", "simplifier", "vertices",
              "mean to", "max to", "mean back", "max back", "mean", "ours/better peer");
  for (const double share : shares) {
    const auto wanted = static_cast<size_t>(std::lround(share * static_cast<double>(all)));
    if (wanted <= ours.report.baseVertices) {
      std::printf("  %5.1f%% is below the base mesh\n", 100 * share);
      continue;
    }
    const size_t splits = wanted - ours.report.baseVertices;
    const std::vector<Row> rows = {
        quality.measure("meshfront rank", meshAfter(*mesh, ours.collapses,
                                                    firstByRank(ours.collapses.size(), splits))),
        quality.measure("meshfront level",
                        meshAfter(*mesh, ours.collapses, firstByLevel(forest, splits))),
        quality.measure("OpenMesh", openMeshDecimated(*mesh, wanted).triangles),
        quality.measure("meshoptimizer", meshoptWithVertices(*mesh, wanted).triangles)};
    const double better = std::min(rows[2].mean(), rows[3].mean());
    for (size_t i = 0; i < rows.size(); ++i) {
      const Row& row = rows[i];
      std::printf("  %5.1f%% %-16s %8zu  %9.2f %9.1f  %9.2f %9.1f  %9.2f", 100 * share, row.name,
                  row.vertices, row.there.mean, row.there.maximum, row.back.mean, row.back.maximum,
                  row.mean());
      if (i < 2) std::printf("  %.3f", row.mean() / better);
      std::printf("\n");
    }
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace meshfront

int main(int argc, char** argv) {
  try {
    CLI::App app("Measures how far simplified meshes are from the input, ours beside peers'");
    std::vector<std::string> paths;
    unsigned bits = meshfront::kDefaultQuantizationBits;
    size_t samples = 200000;
    std::vector<double> shares = {0.2, 0.05, 0.01};
    meshfront::SimplifyOptions options;
    app.add_option("meshes", paths, "Mesh files")->required();
    app.add_option("--quantization", bits, "Bits a coordinate")
        ->capture_default_str()
        ->check(CLI::Range(meshfront::kMinQuantizationBits, meshfront::kMaxQuantizationBits));
    app.add_option("--balance", options.balance, "Power of the tree height in the cost")
        ->capture_default_str()
        ->check(CLI::Range(0, 2));
    app.add_option("--shares", shares, "Of the vertices that are kept")->capture_default_str();
    app.add_option("--samples", samples, "Points spread over each surface")->capture_default_str();
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? 0 : 2;
    }
    int result = 0;
    for (const std::string& path : paths)
      result |= meshfront::bench(path, bits, options, shares, samples);
    return result;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "simplification-quality: %s\n", error.what());
    return 1;
  }
}
