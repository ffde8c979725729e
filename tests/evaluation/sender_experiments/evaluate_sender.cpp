// evaluate-sender: what the sender-driven way and ours cost, on the same packs.
//
//   evaluate-sender bunny.pack igea.pack --path walk.json --output out [--short] [--only
//   cost,bytes]
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>

#include "tests/evaluation/sender_experiments/experiments.h"

namespace meshfront::evaluation {
namespace {

using Experiment = Result<void> (*)(std::span<MeasuredMesh>, const ExperimentOptions&);

const std::vector<std::pair<std::string, Experiment>> kExperiments{
    {"cost", measureWholeMesh},    {"receivers", measureReceivers}, {"bytes", measureBytes},
    {"sessions", measureSessions}, {"client", measureClient},
};

int run(const std::vector<std::string>& packs, const std::vector<std::string>& only,
        const ExperimentOptions& options) {
  using Clock = std::chrono::steady_clock;
  const auto complain = [](const Error& error) {
    std::fprintf(stderr, "evaluate-sender: %s\n", error.message.c_str());
    return 1;
  };
  std::error_code failed;
  std::filesystem::create_directories(options.output, failed);
  if (failed) return complain({ErrorCode::invalid, options.output.string() + ": no such folder"});
  std::vector<MeasuredMesh> meshes;
  for (const std::string& path : packs) {
    const auto start = Clock::now();
    auto mesh = MeasuredMesh::open(path);
    if (!mesh) return complain(mesh.error());
    std::printf("%s: %u nodes, loaded in %.2f s, %.1f MB\n", mesh->name.c_str(),
                mesh->model.nodeCount(),
                std::chrono::duration<double>(Clock::now() - start).count(),
                1e-6 * static_cast<double>(mesh->model.memoryBytes()));
    meshes.push_back(std::move(*mesh));
  }
  for (const auto& [name, experiment] : kExperiments) {
    if (!only.empty() && std::find(only.begin(), only.end(), name) == only.end()) continue;
    const auto start = Clock::now();
    if (const auto done = experiment(meshes, options); !done) return complain(done.error());
    std::printf("%s: %.1f s\n", name.c_str(),
                std::chrono::duration<double>(Clock::now() - start).count());
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace meshfront::evaluation

int main(int argc, char** argv) {
  using namespace meshfront::evaluation;
  CLI::App app{"Measures what the sender-driven way and ours cost; writes CSV files."};
  std::vector<std::string> packs;
  std::vector<std::string> only;
  std::string path;
  ExperimentOptions options;
  app.add_option("PACK", packs, "as meshfront-encode writes it")->required();
  app.add_option("--output", options.output, "folder for what is written")->required();
  app.add_option("--path", path, "camera path (JSON) that is walked twice")->required();
  app.add_option("--only", only, "some of cost, receivers, bytes, sessions, client")
      ->delimiter(',');
  app.add_option("--header-bytes", options.headerBytes, "of each of our answers")
      ->capture_default_str();
  app.add_flag("--short", options.quick, "fewer repetitions and receivers");
  try {
    app.parse(argc, argv);
    const auto read = meshfront::readCameraPath(path);
    if (!read) throw CLI::ValidationError("--path", read.error().message);
    options.path = *read;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return run(packs, only, options);
}
