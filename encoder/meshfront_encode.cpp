// meshfront-encode: a mesh file becomes a pack.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include "encoder/pipeline/base_advice.h"
#include "encoder/pipeline/encode_mesh.h"
#include "encoder/pipeline/phase_clock.h"
#include "encoder/pipeline/progress_bar.h"
#include "encoder/pipeline/signals_held_back.h"
#include "shared/mesh_files/available_memory.h"

namespace {

using namespace meshfront;

Result<void> run(const std::string& input, const std::string& output, EncodeOptions options,
                 bool json) {
  if (options.name.empty()) options.name = std::filesystem::path(output).stem().string();
  if (!isMeshName(options.name))
    return fail("'" + options.name +
                "' is no mesh name (letters, digits, '.', '_', '-', at most 64, no dot first); "
                "choose one with --name");
  const auto folder = std::filesystem::absolute(output).parent_path();
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    return fail(folder.string() +
                ": no pack can be written there: " + std::generic_category().message(errno));
  ProgressBar bar;
  const EncodeProgress progress = [&](const std::string& phase, double done) {
    bar.show(phase, done);
  };
  auto encoded = encodeFile(input, options, progress);
  if (!encoded) return tl::unexpected(encoded.error());
  PhaseClock clock(encoded->report.phases, progress);
  clock.begin("write");
  const SignalsHeldBack held;  // before, there is nothing yet that could be left
  const auto written =
      writePack(output, std::move(encoded->pack), [&] { return held.interrupted(); });
  if (!written) return tl::unexpected(written.error());
  held.ignore();
  clock.end();
  bar.clear();
  for (const std::string& advice :
       adviceOnBase(encoded->report.simplification, written->vertexCount))
    fmt::print(stderr, "meshfront-encode: warning: {}\n", advice);
  if (json) {
    auto out = nlohmann::ordered_json::parse(toJson(encoded->report, true));
    out["metadata"] = nlohmann::ordered_json::parse(toJson(*written));
    fmt::print("{}\n", out.dump(2));
  } else {
    fmt::print("{}wrote       {}: mesh {}, revision {}, base {} bytes, {} chunks, {} bytes\n",
               describe(encoded->report), output, written->name, written->revision,
               written->baseBytes, written->chunkCount, written->chunkBytes);
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Encodes a triangle mesh (PLY, OBJ, STL, OFF, glTF; also .gz, .xz, .zst) into a "
      "pack for meshfront-serve."};
  std::string input;
  std::string output;
  bool json = false;
  uint64_t memoryLimit = 0;
  EncodeOptions options;
  options.threads = std::max(1U, std::thread::hardware_concurrency());
  app.add_option("INPUT", input, "Mesh file")->required();
  app.add_option("--output", output, "Pack to write; replaced whole or not at all")->required();
  app.add_option("--name", options.name, "Name in the catalogue (default: the pack's file name)");
  app.add_option("--quantization", options.quantizationBits,
                 "Bits a coordinate on the grid of the bounding cube")
      ->check(CLI::Range(kMinQuantizationBits, kMaxQuantizationBits))
      ->capture_default_str();
  app.add_option("--normal-bits", options.normalBits,
                 "Bits of each of the two coordinates of the vertices' normals, 4 to 15; 0 leaves "
                 "them out")
      ->check([](const std::string& text) {
        const bool digits = text.find_first_not_of("0123456789") == std::string::npos;
        const unsigned long bits = digits && text.size() < 4 ? std::stoul("0" + text) : 99;
        return bits == 0 || (bits >= kMinNormalBits && bits <= kMaxNormalBits)
                   ? std::string()
                   : "neither 0 nor 4 to 15";
      })
      ->capture_default_str();
  app.add_flag("!--no-colours", options.colours, "Leave the vertices' colours out");
  app.add_option("--base-fraction", options.baseFraction, "Base mesh as a share of the vertices")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--base-limit", options.baseLimit,
                 "Largest base mesh wanted, in vertices, however large the mesh is")
      ->check(CLI::Range(uint64_t{4}, uint64_t{UINT32_MAX}))
      ->capture_default_str();
  app.add_option("--balance", options.balance,
                 "Exponent that keeps trees shallow: 0 (off), 1 or 2 (shallower)")
      ->check(CLI::Range(0, 2))
      ->capture_default_str();
  app.add_option("--max-valence", options.maxValence,
                 "Vertices with more neighbours than this stay in the base mesh")
      ->check(CLI::Range(6U, kLargestMaxValence))
      ->capture_default_str();
  app.add_option("--threads", options.threads, "Threads; the result does not depend on them")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--memory-limit", memoryLimit,
                 "Memory it may take, for example 20GiB; a mesh that is estimated to need more is "
                 "refused (default: what is available)")
      ->transform(CLI::AsSizeValue(false))
      ->check(CLI::PositiveNumber);
  app.add_flag("--json", json, "Report as JSON");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (memoryLimit > 0) {
    options.memoryLimit = memoryLimit;
    options.memoryLimitedBy = "--memory-limit";
  } else {
    const AvailableMemory available = availableMemory();
    options.memoryLimit = available.bytes;
    options.memoryLimitedBy = available.limitedBy;
  }
  try {
    if (const auto done = run(input, output, options, json); !done) {
      fmt::print(stderr, "meshfront-encode: {}\n", done.error().message);
      return 1;
    }
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "meshfront-encode: out of memory; the mesh needs a larger machine\n");
    return 1;
  } catch (const std::exception& error) {  // no thread can be started, no file can be looked at
    fmt::print(stderr, "meshfront-encode: {}\n", error.what());
    return 1;
  }
  return 0;
}
