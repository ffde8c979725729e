// What ranking by pixels costs: a pass with its read-back beside the plain item draw, pair by pair,
// as a Markdown table of medians; what a lower resolution of the items does to the order; and how
// long updates of the mesh take.
//
//   ranking-bench bunny.ply igea.ply gcanyon1200.ply.xz
//
// The order is compared on a coarse mesh, made by merging vertices on a grid: what is ranked is a
// front, whose triangles are larger than the finest ones.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "shared/camera/camera_spec.h"
#include "shared/mesh_files/mesh_files.h"
#include "viewer/gl/gl_context.h"
#include "viewer/gl/ranking_pass.h"

namespace meshfront {
namespace {

using Clock = std::chrono::steady_clock;

struct RankingBenchMesh {
  std::string name;
  Quantization quantization;
  Bounds bounds;
  std::vector<GridPosition> positions;
  std::vector<Triangle> triangles;
};

struct RankingBenchOptions {
  std::vector<std::string> paths;
  int pairs = 15;
  unsigned coarseBits = 7;
  std::string camera = "whole";
  std::string method = "preferred";
};

double medianOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

Result<RankingBenchMesh> loaded(const std::string& path) {
  Result<IndexedMesh> mesh = readMesh(path);
  if (!mesh) return tl::unexpected(mesh.error());
  RankingBenchMesh out;
  out.name = std::filesystem::path(path).filename().string();
  out.quantization = quantizationFor(mesh->positions, kDefaultQuantizationBits);
  std::array<double, 3> low =
      mesh->positions.empty() ? std::array<double, 3>{} : mesh->positions[0];
  std::array<double, 3> high = low;
  for (const auto& position : mesh->positions) {
    out.positions.push_back(out.quantization.toGrid(position));
    for (size_t i = 0; i < 3; ++i) {
      low.at(i) = std::min(low.at(i), position.at(i));
      high.at(i) = std::max(high.at(i), position.at(i));
    }
  }
  out.bounds = Bounds::of(low, high);
  out.triangles = std::move(mesh->triangles);
  return out;
}

// Vertices whose upper `bits` bits agree are one.
RankingBenchMesh coarser(const RankingBenchMesh& mesh, unsigned bits) {
  RankingBenchMesh out = mesh;
  out.positions.clear();
  out.triangles.clear();
  const unsigned shift = mesh.quantization.bits - bits;
  std::map<GridPosition, uint32_t> cells;
  std::vector<uint32_t> cellOf;
  for (const GridPosition& position : mesh.positions) {
    const GridPosition cell = {position[0] >> shift, position[1] >> shift, position[2] >> shift};
    const auto [place, fresh] =
        cells.try_emplace(cell, static_cast<uint32_t>(out.positions.size()));
    if (fresh) out.positions.push_back(position);
    cellOf.push_back(place->second);
  }
  for (const Triangle& t : mesh.triangles) {
    const Triangle merged = {cellOf[t[0]], cellOf[t[1]], cellOf[t[2]]};
    if (merged[0] != merged[1] && merged[1] != merged[2] && merged[2] != merged[0])
      out.triangles.push_back(merged);
  }
  return out;
}

Result<GpuMesh> onGpu(const RankingBenchMesh& mesh) {
  GpuMesh gpuMesh;
  const Result<bool> uploaded =
      gpuMesh.update({mesh.quantization, mesh.positions, mesh.triangles, 1});
  if (!uploaded) return tl::unexpected(uploaded.error());
  return gpuMesh;
}

class RankingBench {
 public:
  static Result<RankingBench> create(const RankingBenchOptions& options) {
    auto context = GlContext::createHeadless();
    if (!context) return tl::unexpected(context.error());
    auto renderer = MeshRenderer::create();
    if (!renderer) return tl::unexpected(renderer.error());
    auto camera = parseCameraSpec(options.camera);
    if (!camera) return tl::unexpected(camera.error());
    PixelCounter::Method method = PixelCounter::preferred(*context);
    if (options.method == "compute") method = PixelCounter::Method::compute;
    if (options.method == "read-back") method = PixelCounter::Method::readBack;
    auto pass = RankingPass::create(method);
    if (!pass) return tl::unexpected(pass.error());
    return RankingBench(options, std::move(*context), std::move(*renderer), std::move(*pass),
                        *camera);
  }

  [[nodiscard]] std::string description() const {
    const bool compute = pass_.counter().method() == PixelCounter::Method::compute;
    return context_.description() + ", counted " + (compute ? "by compute" : "on the CPU");
  }

  // The waits are what a caller that wants the counts at once would wait.
  Result<void> timePasses(const RankingBenchMesh& mesh, PixelSize size) {
    const Result<GpuMesh> gpuMesh = onGpu(mesh);
    if (!gpuMesh) return tl::unexpected(gpuMesh.error());
    const std::array<MeshInstance, 1> scene = {MeshInstance{&*gpuMesh}};
    auto target = RenderTarget::create(size);
    if (!target) return tl::unexpected(target.error());
    const RankingView view = viewOf(mesh, size, 1);
    const auto draw = [&](bool shaded) {
      const auto start = Clock::now();
      if (shaded) {
        renderer_.draw(*target, scene, view.camera, view.bounds, {});
      } else {
        renderer_.drawItems(*target, scene, view.camera, view.bounds);
      }
      (void)target->itemAt(0, 0);  // waits for all of it
      return millisecondsSince(start);
    };
    std::vector<double> frames;
    std::vector<double> items;
    std::vector<double> rankings;
    std::vector<double> ratios;
    for (int pair = -1; pair < options_.pairs; ++pair) {
      double plain = 0;
      double ranking = 0;
      const bool plainFirst = pair % 2 == 0;
      for (const bool isPlain : {plainFirst, !plainFirst}) {
        if (isPlain) {
          plain = draw(false);
        } else {
          const auto start = Clock::now();
          if (auto ranked = rank(scene, view); !ranked) return tl::unexpected(ranked.error());
          ranking = millisecondsSince(start);
        }
      }
      const double frame = draw(true);
      if (pair < 0) continue;  // warming up
      frames.push_back(frame);
      items.push_back(plain);
      rankings.push_back(ranking);
      ratios.push_back(ranking / plain);
    }
    std::printf("| %s | %zu | %dx%d | %.2f | %.2f | %.2f | %.3f |\n", mesh.name.c_str(),
                mesh.triangles.size(), size.width, size.height, medianOf(frames), medianOf(items),
                medianOf(rankings), medianOf(ratios));
    std::fflush(stdout);
    return {};
  }

  // Vertices and faces in random places, as splits all over a mesh change them.
  Result<void> timeUpdates(const RankingBenchMesh& mesh) {
    Result<MeshUpdate> whole = updateFrom({mesh.quantization, mesh.positions, mesh.triangles, 1});
    if (!whole) return tl::unexpected(whole.error());
    std::mt19937 random(1);
    for (const size_t wanted : {size_t{1'000}, size_t{10'000}, size_t{60'000}, SIZE_MAX}) {
      MeshUpdate update = wanted < mesh.positions.size() ? partOf(*whole, wanted, random) : *whole;
      const size_t vertices = update.slots.size();
      const size_t bytes = update.byteCount();
      std::array<double, 2> medians{};
      for (const auto way : {UpdateUpload::Way::map, UpdateUpload::Way::scatter}) {
        GpuMesh gpuMesh(mesh.quantization, false, way);
        if (auto applied = gpuMesh.apply(*whole); !applied) return tl::unexpected(applied.error());
        std::vector<double> times;
        for (int run = 0; run < options_.pairs; ++run) {
          MeshUpdate copy = update;
          (void)gpuMesh.vertexAt(0);  // waits for what was done before
          const auto start = Clock::now();
          if (auto applied = gpuMesh.apply(std::move(copy)); !applied)
            return tl::unexpected(applied.error());
          (void)gpuMesh.vertexAt(0);
          times.push_back(millisecondsSince(start));
        }
        medians.at(way == UpdateUpload::Way::map ? 0 : 1) = medianOf(times);
      }
      std::printf("| %s | %zu | %zu | %.1f | %.2f | %.2f |\n", mesh.name.c_str(), vertices,
                  update.faces.size(), static_cast<double>(bytes) / 1e6, medians[0], medians[1]);
      std::fflush(stdout);
    }
    return {};
  }

  Result<void> compareOrders(const RankingBenchMesh& mesh, PixelSize size) {
    const Result<GpuMesh> gpuMesh = onGpu(mesh);
    if (!gpuMesh) return tl::unexpected(gpuMesh.error());
    const std::array<MeshInstance, 1> scene = {MeshInstance{&*gpuMesh}};
    std::vector<uint32_t> whole;
    for (const int divisor : {1, 2, 4}) {
      std::vector<double> times;
      Result<PixelCounts> counts = tl::unexpected(Error{});
      for (int run = 0; run < options_.pairs; ++run) {
        const auto start = Clock::now();
        counts = rank(scene, viewOf(mesh, size, divisor));
        if (!counts) return tl::unexpected(counts.error());
        times.push_back(millisecondsSince(start));
      }
      const std::vector<uint32_t>& pixels = counts->pixels[0];
      if (divisor == 1) whole = pixels;
      const auto seen = [](const std::vector<uint32_t>& list) {
        return list.size() - static_cast<size_t>(std::count(list.begin(), list.end(), uint32_t{0}));
      };
      std::printf("| %s | %zu | %dx%d | 1/%d | %.2f | %zu | %.3f | %.3f |\n", mesh.name.c_str(),
                  mesh.triangles.size(), size.width, size.height, divisor, medianOf(times),
                  seen(pixels), sharedOfBest(whole, pixels, 1000), kendallTau(whole, pixels));
      std::fflush(stdout);
    }
    return {};
  }

 private:
  RankingBench(RankingBenchOptions options, GlContext context, MeshRenderer renderer,
               RankingPass pass, const CameraSpec& camera)
      : options_(std::move(options)),
        context_(std::move(context)),
        renderer_(std::move(renderer)),
        pass_(std::move(pass)),
        camera_(camera) {}

  [[nodiscard]] RankingView viewOf(const RankingBenchMesh& mesh, PixelSize size,
                                   int divisor) const {
    RankingView view;
    view.camera = placeCamera(camera_, mesh.bounds, size.aspect());
    view.bounds = mesh.bounds;
    view.size = size;
    view.divisor = divisor;
    return view;
  }

  // Of `vertices` random vertices, and twice as many faces.
  static MeshUpdate partOf(const MeshUpdate& whole, size_t vertices, std::mt19937& random) {
    MeshUpdate part;
    part.changeCount = 2;
    part.vertexSlots = whole.vertexSlots;
    part.faceSlots = whole.faceSlots;
    std::sample(whole.slots.begin(), whole.slots.end(), std::back_inserter(part.slots), vertices,
                random);
    std::sample(whole.faces.begin(), whole.faces.end(), std::back_inserter(part.faces),
                2 * vertices, random);
    for (const uint32_t slot : part.slots) part.vertices.push_back(whole.vertices[slot]);
    for (const uint32_t face : part.faces) part.corners.push_back(whole.corners[face]);
    return part;
  }

  Result<PixelCounts> rank(std::span<const MeshInstance> scene, const RankingView& view) {
    const Result<bool> started = pass_.start(renderer_, scene, view);
    if (!started) return tl::unexpected(started.error());
    PixelCounts counts;
    while (!pass_.take(counts)) {
    }
    return counts;
  }

  // The share of the `most` vertices with the largest counts that both have; ties by slot.
  static double sharedOfBest(const std::vector<uint32_t>& a, const std::vector<uint32_t>& b,
                             size_t most) {
    const auto best = [most](const std::vector<uint32_t>& counts) {
      std::vector<uint32_t> order(counts.size());
      std::iota(order.begin(), order.end(), 0U);
      const auto end = order.begin() + static_cast<std::ptrdiff_t>(std::min(most, order.size()));
      std::partial_sort(order.begin(), end, order.end(), [&counts](uint32_t x, uint32_t y) {
        return counts[x] != counts[y] ? counts[x] > counts[y] : x < y;
      });
      order.erase(end, order.end());
      std::sort(order.begin(), order.end());
      return order;
    };
    const std::vector<uint32_t> first = best(a);
    const std::vector<uint32_t> second = best(b);
    std::vector<uint32_t> both;
    std::set_intersection(first.begin(), first.end(), second.begin(), second.end(),
                          std::back_inserter(both));
    return static_cast<double>(both.size()) /
           static_cast<double>(std::max<size_t>(1, first.size()));
  }

  // Tau-b of what `a` counts at all, on a million random pairs.
  static double kendallTau(const std::vector<uint32_t>& a, const std::vector<uint32_t>& b) {
    std::vector<uint32_t> seen;
    for (uint32_t v = 0; v < a.size(); ++v)
      if (a[v] > 0) seen.push_back(v);
    if (seen.size() < 2) return 1;
    std::mt19937 random(1);
    std::uniform_int_distribution<size_t> any(0, seen.size() - 1);
    double agreed = 0;
    double untiedInA = 0;
    double untiedInB = 0;
    for (int i = 0; i < 1'000'000; ++i) {
      const uint32_t x = seen[any(random)];
      const uint32_t y = seen[any(random)];
      const int inA = (a[x] > a[y] ? 1 : 0) - (a[x] < a[y] ? 1 : 0);
      const int inB = (b[x] > b[y] ? 1 : 0) - (b[x] < b[y] ? 1 : 0);
      agreed += inA * inB;
      untiedInA += std::abs(inA);
      untiedInB += std::abs(inB);
    }
    const double scale = std::sqrt(untiedInA * untiedInB);
    return scale > 0 ? agreed / scale : 1;
  }

  RankingBenchOptions options_;
  GlContext context_;
  MeshRenderer renderer_;
  RankingPass pass_;
  CameraSpec camera_;
};

Result<void> benchRanking(const RankingBenchOptions& options) {
  Result<RankingBench> bench = RankingBench::create(options);
  if (!bench) return tl::unexpected(bench.error());
  std::vector<RankingBenchMesh> meshes;
  for (const std::string& path : options.paths) {
    Result<RankingBenchMesh> mesh = loaded(path);
    if (!mesh) return tl::unexpected(mesh.error());
    meshes.push_back(std::move(*mesh));
  }
  std::printf("%s; medians of %d pairs, milliseconds\n\n", bench->description().c_str(),
              options.pairs);
  std::puts("| mesh | triangles | picture | shaded frame | item draw | ranking pass | ratio |");
  std::puts("|---|---|---|---|---|---|---|");
  for (const RankingBenchMesh& mesh : meshes)
    for (const PixelSize size : {PixelSize{1280, 720}, PixelSize{500, 500}})
      if (Result<void> timed = bench->timePasses(mesh, size); !timed) return timed;
  std::puts(
      "\n| coarse mesh | triangles | picture | resolution | ranking pass | vertices counted "
      "| best 1000 shared | Kendall's tau |");
  std::puts("|---|---|---|---|---|---|---|---|");
  for (const RankingBenchMesh& mesh : meshes) {
    const RankingBenchMesh coarse = coarser(mesh, options.coarseBits);
    if (Result<void> compared = bench->compareOrders(coarse, {1280, 720}); !compared)
      return compared;
  }
  std::puts(
      "\n| mesh | vertices changed | faces changed | megabytes | by mapping | by scattering |");
  std::puts("|---|---|---|---|---|---|");
  for (const RankingBenchMesh& mesh : meshes)
    if (Result<void> timed = bench->timeUpdates(mesh); !timed) return timed;
  const std::string errors = takeGlErrors();
  return errors.empty() ? Result<void>() : fail(errors);
}

}  // namespace
}  // namespace meshfront

int main(int argc, char** argv) {
  try {
    CLI::App app("Times ranking by pixels beside the plain item draw, without a window");
    meshfront::RankingBenchOptions options;
    app.add_option("meshes", options.paths, "Mesh files")->required();
    app.add_option("--pairs", options.pairs, "Runs of each, interleaved; medians are told")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000));
    app.add_option("--coarse-bits", options.coarseBits,
                   "Grid of the coarse meshes, bits a coordinate")
        ->capture_default_str()
        ->check(CLI::Range(2, 13));
    app.add_option("--camera", options.camera, "As meshfront-view's")->capture_default_str();
    app.add_option("--method", options.method, "How pixels are counted")
        ->capture_default_str()
        ->check(CLI::IsMember({"preferred", "compute", "read-back"}));
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? 0 : 2;
    }
    const auto done = meshfront::benchRanking(options);
    if (!done) std::fprintf(stderr, "ranking-bench: %s\n", done.error().message.c_str());
    return done ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ranking-bench: %s\n", error.what());
    return 1;
  }
}
