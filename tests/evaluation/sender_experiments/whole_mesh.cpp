// Experiment 1, Cheng and Ooi 2008, table 1: what the sender computes to send a whole mesh.
#include <algorithm>
#include <array>
#include <limits>

#include "shared/http/split_request.h"
#include "shared/receiver/request_budget.h"
#include "tests/evaluation/csv_file.h"
#include "tests/evaluation/sender_experiments/experiments.h"

namespace meshfront::evaluation {
namespace {

struct SenderVariant {
  const char* name = "";
  SenderOptions options;
};

const std::array kVariants{
    SenderVariant{"front; bitstring",
                  {Bookkeeping::vertexFront, SenderOrder::error, IdCoding::bitstring}},
    SenderVariant{"tags; bitstring",
                  {Bookkeeping::windowedTags, SenderOrder::error, IdCoding::bitstring}},
    SenderVariant{"tags; adaptive",
                  {Bookkeeping::windowedTags, SenderOrder::error, IdCoding::adaptive}},
    SenderVariant{"tags; adaptive; significance",
                  {Bookkeeping::windowedTags, SenderOrder::significance, IdCoding::adaptive}},
    SenderVariant{"front; published IDs",
                  {Bookkeeping::vertexFront, SenderOrder::error, IdCoding::published}},
    // The active nodes are tested again for each batch.
    SenderVariant{"as published: front tested each batch; published IDs",
                  {Bookkeeping::vertexFront, SenderOrder::error, IdCoding::published, false, true}},
};

constexpr std::array kTimedParts{&SenderTimes::findSplits, &SenderTimes::visibility,
                                 &SenderTimes::frontUpdate, &SenderTimes::encodeIds};

// The processor's time for all of it; parts apart, where they are asked for.
double sendAll(const MeasuredMesh& mesh, const SenderOptions& options, SenderTimes* times) {
  ViewRequest view = mesh.view(mesh.camera("whole"));
  view.everything = true;
  const double start = processorSeconds();
  SenderSession session(mesh.model, options);
  session.measure(times);
  session.look(view);
  while (!session.next(adaptiveBatch(session.sentCount())).splits.empty()) continue;
  const double seconds = processorSeconds() - start;
  return session.sentCount() == mesh.model.nodeCount() ? seconds
                                                       : std::numeric_limits<double>::quiet_NaN();
}

double copyBase(const MeasuredMesh& mesh) {
  const double start = processorSeconds();
  const std::vector<uint8_t> copy(mesh.model.baseBytes().begin(), mesh.model.baseBytes().end());
  const double seconds = processorSeconds() - start;
  return copy.empty() ? 0 : seconds;
}

class CostTable {
 public:
  explicit CostTable(const std::filesystem::path& folder)
      : csv_(folder / "sender_cost.csv",
             {"mesh", "way", "variant", "part", "records", "seconds", "ns_per_record"}) {}
  void row(const MeasuredMesh& mesh, const char* way, const char* variant, const char* part,
           double seconds) {
    const uint32_t records = mesh.model.nodeCount();
    csv_.row(mesh.name, way, variant, part, records, seconds, 1e9 * seconds / records);
  }
  Result<void> close() { return csv_.close(); }

 private:
  CsvFile csv_;
};

void measureSender(const MeasuredMesh& mesh, const SenderVariant& variant, int runs, double base,
                   CostTable& table) {
  double total = std::numeric_limits<double>::infinity();
  SenderTimes best;
  for (int run = 0; run < runs; ++run) {
    total = std::min(total, sendAll(mesh, variant.options, nullptr));
    SenderTimes times;
    (void)sendAll(mesh, variant.options, &times);
    if (run == 0) best = times;
    for (double SenderTimes::*part : kTimedParts) best.*part = std::min(best.*part, times.*part);
  }
  const auto row = [&](const char* part, double seconds) {
    table.row(mesh, "sender-driven", variant.name, part, seconds);
  };
  row("base", base);
  row("decode IDs", 0);
  row("find splits", best.findSplits);
  row("visibility", best.visibility);
  row("front update", best.frontUpdate);
  row("encode IDs", best.encodeIds);
  row("all parts", best.total());
  row("total", total);
}

Result<void> measureOurs(const MeasuredMesh& mesh, int runs, double base, CostTable& table) {
  const auto requests = wholeMeshRequests(mesh.model);
  if (!requests) return tl::unexpected(requests.error());
  double decode = std::numeric_limits<double>::infinity();
  double total = decode;
  for (int run = 0; run < runs + 1; ++run) {  // the first one indexes the chunks
    uint64_t bytes = 0;
    double start = processorSeconds();
    for (const SetRequest& request : *requests)
      if (!answerRequest(*mesh.store, request, bytes)) return fail("the service has no answer");
    if (run > 0) total = std::min(total, processorSeconds() - start);
    start = processorSeconds();
    size_t ids = 0;
    for (const SetRequest& request : *requests)
      ids += parseSplitUrl(request.ids, false, {}, 0, size_t{1} << 18)->wanted.size();
    if (ids != mesh.model.nodeCount()) return fail("the requests are not for the whole mesh");
    decode = std::min(decode, processorSeconds() - start);
  }
  const auto row = [&](const char* part, double seconds) {
    table.row(mesh, "receiver-driven", "significance; URL", part, seconds);
  };
  row("base", base);
  row("decode IDs", decode);
  row("find splits", total - decode);
  row("visibility", 0);
  row("front update", 0);
  row("encode IDs", 0);
  row("total", total);
  return {};
}

}  // namespace

Result<void> measureWholeMesh(std::span<MeasuredMesh> meshes, const ExperimentOptions& options) {
  CostTable table(options.output);
  for (const MeasuredMesh& mesh : meshes) {
    // The best of as many as take a second or so.
    const int runs = std::clamp(static_cast<int>(5e5 / mesh.model.nodeCount()), 3, 9);
    double base = std::numeric_limits<double>::infinity();
    for (int run = 0; run < 20; ++run) base = std::min(base, copyBase(mesh));
    if (auto ours = measureOurs(mesh, runs, base, table); !ours) return ours;
    for (const SenderVariant& variant : kVariants) measureSender(mesh, variant, runs, base, table);
  }
  return table.close();
}

}  // namespace meshfront::evaluation
