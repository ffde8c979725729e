// Prints how long a view takes to settle over links of several round trips, and what it costs, in
// time that is only counted: with and without asking for descendants by need, with windows of one,
// two and as many requests as the link is measured to carry.
//
//   receiver-latency [AROUND ACROSS [MBIT]]
//
// The mesh is a bumpy torus of AROUND times ACROSS vertices, seen from one side in 1280x720.
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "load/projected_pixels.h"
#include "shared/camera/camera_spec.h"
#include "shared/receiver/receiver.h"
#include "tests/unit/delayed_service.h"

namespace meshfront {
namespace {

using Seconds = DelayedService::Seconds;

constexpr PixelSize kPicture{1280, 720};

struct Cost {
  double settled = 0;  // seconds
  double half = 0;     // until half of the records were there
  uint64_t bytes = 0;
  uint64_t requests = 0;
  uint64_t records = 0;
  uint64_t expanded = 0;
  size_t most = 0;
};

Cost run(const MeshService& service, double roundTrip, double bytesPerSecond, uint32_t window,
         bool descendants, uint64_t halfway) {
  DelayedService link(service, Seconds(roundTrip), bytesPerSecond);
  ReceiverOptions options;
  options.freshRanking = false;
  options.window = window;
  options.descendants = descendants;
  options.clock = [&link] { return link.now(); };
  const auto begin = link.now();
  Receiver receiver(*parseMeshUrl("http://host/v1/meshes/torus"), options, link);
  ProjectedPixels pixels;
  std::optional<Camera> camera;
  Cost cost;
  while (receiver.isAtWork()) {
    if (!link.deliver() && !receiver.waitForArrival(std::chrono::milliseconds(0)) &&
        !receiver.wantsRanking())
      break;
    (void)receiver.advance();
    if (cost.half == 0 && receiver.statistics().records >= halfway)
      cost.half = Seconds(link.now() - begin).count();
    if (receiver.mesh() == nullptr) continue;
    const Bounds bounds = Bounds::of({0, 0, 0}, {16'000, 16'000, 16'000});
    if (!camera) camera = placeCamera(CameraSpec{}, bounds, kPicture.aspect());
    receiver.rank(pixels.count(*receiver.mesh(), receiver.metadata()->quantization, bounds, *camera,
                               kPicture));
  }
  if (receiver.state() != ReceiverState::settled && receiver.state() != ReceiverState::complete)
    std::printf("ended as %s: %s\n", stateName(receiver.state()), receiver.reason().c_str());
  const ReceiverStatistics& statistics = receiver.statistics();
  cost.settled = Seconds(link.now() - begin).count();
  cost.bytes = statistics.answerBytesDown;
  cost.requests = statistics.requests;
  cost.records = statistics.records;
  cost.expanded = statistics.expanded;
  cost.most = link.most;
  return cost;
}

}  // namespace
}  // namespace meshfront

int main(int argc, char** argv) {
  using namespace meshfront;
  const uint32_t around = argc > 2 ? static_cast<uint32_t>(std::atoi(argv[1])) : 300;
  const uint32_t across = argc > 2 ? static_cast<uint32_t>(std::atoi(argv[2])) : 150;
  const double megabits = argc > 3 ? std::atof(argv[3]) : 20;
  const MeshService service(TestMesh::torus(around, across));
  std::printf("%llu records, %g Mbit/s\n", static_cast<unsigned long long>(service.splitCount()),
              megabits);
  std::printf(
      "| round trip | window | descendants | settled, s | half, s | record bytes | records "
      "| requests | expanded | most under way |\n|--:|--:|--|--:|--:|--:|--:|--:|--:|--:|\n");
  for (const double milliseconds : {1.0, 20.0, 100.0, 300.0}) {
    const double bytesPerSecond = megabits * 1e6 / 8;
    const uint64_t all =
        run(service, milliseconds / 1e3, bytesPerSecond, 2, false, UINT64_MAX).records;
    for (const uint32_t window : {1U, 2U, 0U}) {
      for (const bool descendants : {false, true}) {
        const Cost cost =
            run(service, milliseconds / 1e3, bytesPerSecond, window, descendants, all / 2);
        std::printf("| %g ms | %s | %s | %.2f | %.2f | %llu | %llu | %llu | %llu | %zu |\n",
                    milliseconds, window == 0 ? "measured" : std::to_string(window).c_str(),
                    descendants ? "by need" : "no", cost.settled, cost.half,
                    static_cast<unsigned long long>(cost.bytes),
                    static_cast<unsigned long long>(cost.records),
                    static_cast<unsigned long long>(cost.requests),
                    static_cast<unsigned long long>(cost.expanded), cost.most);
      }
    }
  }
  return 0;
}
