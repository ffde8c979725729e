// Experiment 1, second part: what a receiver costs the sender while it moves, for 1 to 1,000
// receivers at a time on paths of their own. The service answers for the same records.
#include <cmath>
#include <numbers>

#include "shared/receiver/request_budget.h"
#include "tests/evaluation/csv_file.h"
#include "tests/evaluation/sender_experiments/experiments.h"

namespace meshfront::evaluation {
namespace {

constexpr unsigned kViews = 48;
constexpr unsigned kFewViews = 12;  // where there are very many receivers
constexpr double kTurn = 180;       // degrees, all in all

// Half a turn around the mesh, from a start of its own, into a close-up and out again.
Camera cameraOf(const MeasuredMesh& mesh, unsigned receiver, unsigned receivers, unsigned view,
                unsigned views) {
  const double azimuth = 360.0 * receiver / receivers + kTurn * view / views;
  const double wave = std::sin(std::numbers::pi * view / views);
  const double elevation = 20 + 25 * std::sin(2.4 * receiver) * wave;
  const double zoom = 1 + 2 * wave * (receiver % 3) / 2;
  return mesh.camera("azimuth=" + std::to_string(azimuth) +
                     ";elevation=" + std::to_string(elevation) + ";zoom=" + std::to_string(zoom));
}

struct ReceiverCosts {
  double sender = 0;  // seconds
  double service = 0;
  uint64_t records = 0;
  uint64_t requests = 0;
  size_t sessionBytes = 0;
};

Result<ReceiverCosts> serveReceivers(const MeasuredMesh& mesh, const SenderOptions& options,
                                     unsigned receivers, unsigned views) {
  ReceiverCosts costs;
  std::vector<std::unique_ptr<SenderSession>> sessions;
  for (unsigned i = 0; i < receivers; ++i)
    sessions.push_back(std::make_unique<SenderSession>(mesh.model, options));
  std::vector<uint32_t> nodes;
  uint64_t bytes = 0;
  for (unsigned view = 0; view < views; ++view) {
    for (unsigned i = 0; i < receivers; ++i) {
      SenderSession& session = *sessions[i];
      const ViewRequest request = mesh.view(cameraOf(mesh, i, receivers, view, views));
      nodes.clear();
      double start = processorSeconds();
      session.look(request);
      for (;;) {
        const SentBatch& batch = session.next(adaptiveBatch(session.sentCount()));
        if (batch.splits.empty()) break;
        for (const SentSplit& split : batch.splits) nodes.push_back(split.node);
      }
      costs.sender += processorSeconds() - start;
      costs.records += nodes.size();
      const auto requests = requestsFor(mesh.model, nodes);
      if (!requests) return tl::unexpected(requests.error());
      costs.requests += requests->size();
      start = processorSeconds();
      for (const SetRequest& wanted : *requests)
        if (!answerRequest(*mesh.store, wanted, bytes)) return fail("the service has no answer");
      costs.service += processorSeconds() - start;
    }
  }
  for (const auto& session : sessions) costs.sessionBytes += session->sessionBytes();
  return costs;
}

}  // namespace

Result<void> measureReceivers(std::span<MeasuredMesh> meshes, const ExperimentOptions& options) {
  CsvFile csv(options.output / "receivers.csv",
              {"mesh", "receivers", "variant", "views", "records", "requests", "sender_seconds",
               "service_seconds", "sender_ms_a_receiver", "service_ms_a_receiver", "ratio",
               "session_bytes_a_receiver"});
  struct Variant {
    const char* name = "";
    SenderOptions options;
  };
  const std::array variants{
      // The cheapest, and the one with the fewest octets.
      Variant{"front; published IDs",
              {Bookkeeping::vertexFront, SenderOrder::error, IdCoding::published}},
      Variant{"tags; adaptive",
              {Bookkeeping::windowedTags, SenderOrder::error, IdCoding::adaptive}}};
  for (const MeasuredMesh& mesh : meshes) {
    // The service indexes its chunks when they are first asked for.
    const auto everything = wholeMeshRequests(mesh.model);
    if (!everything) return tl::unexpected(everything.error());
    uint64_t bytes = 0;
    for (const SetRequest& request : *everything)
      if (!answerRequest(*mesh.store, request, bytes)) return fail("the service has no answer");
    const auto measure = [&](unsigned receivers, unsigned views) -> Result<void> {
      for (const Variant& variant : variants) {
        const auto costs = serveReceivers(mesh, variant.options, receivers, views);
        if (!costs) return tl::unexpected(costs.error());
        csv.row(mesh.name, receivers, variant.name, views, costs->records, costs->requests,
                costs->sender, costs->service, 1e3 * costs->sender / receivers,
                1e3 * costs->service / receivers, costs->service / costs->sender,
                costs->sessionBytes / receivers);
      }
      return {};
    };
    // As many receivers as there is time for: 1,000 of a mesh like the bunny.
    const double affordable = (options.quick ? 1e6 : 4e7) / mesh.model.nodeCount();
    for (const unsigned receivers : {1U, 10U, 100U, 1000U})
      if (receivers == 1 || receivers < affordable)
        if (auto done = measure(receivers, receivers < 1000 ? kViews : kFewViews); !done)
          return done;
    // The same way at other speeds.
    for (const unsigned views : {kFewViews, 192U, 768U})
      if (auto done = measure(1, views); !done) return done;
  }
  return csv.close();
}

}  // namespace meshfront::evaluation
