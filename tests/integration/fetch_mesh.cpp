// fetch-mesh URL OUTPUT.ply [chunks]: takes the whole mesh with the viewer's receiver, without GL,
// going on by itself whenever that is stuck, and writes it. Tests compare it with what was encoded.
// Prints how often it went on and how many answers were damaged. Exit codes: 0, 1 failed, 2 usage.
#include <chrono>
#include <cstdio>
#include <string_view>
#include <thread>
#include <vector>

#include "shared/mesh_files/mesh_files.h"
#include "shared/receiver/http_fetcher.h"
#include "shared/receiver/receiver.h"

namespace {

using namespace meshfront;

constexpr std::chrono::milliseconds kResumeInterval{500};

Result<void> write(const Receiver& receiver, const char* path) {
  const GridMesh mesh = receiver.mesh()->snapshot();
  std::vector<std::array<double, 3>> world;
  world.reserve(mesh.positions.size());
  for (const GridPosition& position : mesh.positions)
    world.push_back(receiver.metadata()->quantization.toWorld(position));
  return writePly(path, world, mesh.triangles, {});
}

int fetchMesh(const MeshUrl& url, const char* path, FetchMode mode) {
  HttpFetcher http;
  ReceiverOptions options;
  options.mode = mode;
  options.goal = ReceiverOptions::Goal::complete;
  Receiver receiver(url, options, http);
  unsigned resumed = 0;
  while (receiver.state() != ReceiverState::complete) {
    if (receiver.state() == ReceiverState::degraded) {
      std::this_thread::sleep_for(kResumeInterval);
      if (!receiver.resume()) break;
      ++resumed;
    }
    static_cast<void>(receiver.waitForArrival(std::chrono::milliseconds(50)));
    static_cast<void>(receiver.advance());
    if (receiver.wantsRanking())
      receiver.rank(std::vector<uint32_t>(receiver.mesh()->vertexSlotCount(), 1));
  }
  std::printf("%u %llu\n", resumed,
              static_cast<unsigned long long>(receiver.statistics().malformed));
  if (receiver.state() != ReceiverState::complete) {
    std::fprintf(stderr, "fetch-mesh: %s\n", receiver.reason().c_str());
    return 1;
  }
  if (const auto written = write(receiver, path); !written) {
    std::fprintf(stderr, "fetch-mesh: %s\n", written.error().message.c_str());
    return 1;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const auto url = argc >= 3 ? meshfront::parseMeshUrl(argv[1]) : meshfront::fail("no URL");
  const bool chunks = argc == 4 && std::string_view(argv[3]) == "chunks";
  if (!url || argc > 4 || (argc == 4 && !chunks)) {
    std::fprintf(stderr, "usage: fetch-mesh URL OUTPUT.ply [chunks]\n");
    return 2;
  }
  return fetchMesh(*url, argv[2],
                   chunks ? meshfront::FetchMode::chunks : meshfront::FetchMode::exact);
}
