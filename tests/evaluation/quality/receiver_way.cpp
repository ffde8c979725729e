#include "tests/evaluation/quality/receiver_way.h"

#include <algorithm>
#include <utility>

#include "shared/receiver/first_request.h"
#include "shared/receiver/request_budget.h"
#include "shared/scene/seen_rim.h"
#include "tests/evaluation/quality/ring_shape.h"

namespace meshfront::evaluation {
namespace {

constexpr size_t kRestBatch = 4'000;  // nothing is ranked by the picture any more

}  // namespace

ReceiverWay::ReceiverWay(RefinedPack refined, const ReceiverOrder& order, Easel& easel,
                         const EvaluationView& view, const ReceiverWayOptions& options)
    : Way(std::move(refined), easel, view), order_(order), options_(options), goal_(options.goal) {}

Result<std::unique_ptr<ReceiverWay>> ReceiverWay::create(const PackRecords& pack,
                                                         const ReceiverOrder& order, Easel& easel,
                                                         const EvaluationView& view,
                                                         const ReceiverWayOptions& options) {
  Result<RefinedPack> refined = RefinedPack::fromBase(pack);
  if (!refined) return tl::unexpected(refined.error());
  std::unique_ptr<ReceiverWay> way(
      new ReceiverWay(std::move(*refined), order, easel, view, options));
  way->cost_.bytesDown = 1;
  if (options.service != nullptr) {
    const Result<ExchangeBytes> metadata = options.service->metadata();
    if (!metadata) return tl::unexpected(metadata.error());
    const Result<ExchangeBytes> base = options.service->base();
    if (!base) return tl::unexpected(base.error());
    way->cost_.bytesDown = metadata->down + base->down;
    way->cost_.bytesUp = metadata->up + base->up;
  }
  return way;
}

bool ReceiverWay::isAllowed(NodeIndex node) const {
  if (options_.allowed.empty()) return true;
  const RecordIndex record = refined_.recordOf(node);
  return record != kNoRecord && options_.allowed[record] != 0;
}

Result<bool> ReceiverWay::advance(uint64_t) {
  if (!started_) {
    started_ = true;
    if (Result<void> ranked = rank(); !ranked) return tl::unexpected(ranked.error());
  }
  if (flights_.empty()) return false;
  const Flight flight = std::move(flights_.front());
  flights_.pop_front();
  if (Result<void> done = refined_.splitAll(flight.records); !done)
    return tl::unexpected(done.error());
  cost_.records += flight.records.size();
  cost_.bytesDown += flight.bytes.down;
  cost_.bytesUp += flight.bytes.up;
  if (Result<void> ranked = rank(); !ranked) return tl::unexpected(ranked.error());
  return true;
}

// Fresh counts; sends what there is room for.
Result<void> ReceiverWay::rank() {
  const auto counted = canvas_.count();
  if (!counted) return tl::unexpected(counted.error());
  const std::vector<uint32_t> pixels = pixelsWithRim(*counted);
  busy_.resize(refined_.mesh().nodeCount(), 0);
  std::vector<Candidate> candidates = visibleCandidates(refined_.mesh(), pixels, busy_);
  for (Candidate& candidate : candidates)
    if ((*counted)[candidate.slot] == 0)
      candidate.level = static_cast<uint8_t>(candidate.level + kRimLevelsBehind);
  std::erase_if(candidates, [this](const Candidate& c) { return !isAllowed(c.node); });
  size_t batch =
      options_.batch > 0 ? options_.batch : adaptiveBatch(refined_.mesh().splitsApplied());
  const RankContext context{refined_, pixels, canvas_.view(), canvas_.easel().size()};
  if (candidates.empty() && flights_.empty()) {
    if (goal_ == ReceiverGoal::seen) return {};
    candidates = restCandidates(*counted);
    batch = std::max(batch, kRestBatch);
    meshfront::keepFirst(candidates, batch, RankOrder::significance);
  } else {
    order_.keepFirst(context, candidates, options_.window * batch);
  }
  size_t next = 0;
  while (flights_.size() < options_.window && next < candidates.size()) {
    const size_t count = std::min(batch, candidates.size() - next);
    if (Result<void> sent = send(std::span(candidates).subspan(next, count)); !sent) return sent;
    next += count;
  }
  return {};
}

// A pixel for each vertex of the rim, where it joins.
std::vector<uint32_t> ReceiverWay::pixelsWithRim(std::span<const uint32_t> pixels) const {
  std::vector<uint32_t> all(pixels.begin(), pixels.end());
  const SelectivelyRefinedMesh& mesh = refined_.mesh();
  if (!order_.withRim || !options_.rim || !rimJoins(seenPixels(mesh, pixels))) return all;
  const Camera& camera = canvas_.view().camera;
  const glm::dvec3 eye = eyeOnGrid(camera, refined_.pack().metadata().quantization);
  for (const VertexSlot slot :
       openRim(mesh, pixels, eye, pixelsAtOne(camera, canvas_.easel().size())))
    all[slot] = 1;
  return all;
}

// What has an edge to something seen, if there is any, else all if that is wanted.
std::vector<Candidate> ReceiverWay::restCandidates(std::span<const uint32_t> pixels) const {
  const SelectivelyRefinedMesh& mesh = refined_.mesh();
  std::vector<Candidate> all = allCandidates(mesh, busy_);
  std::erase_if(all, [this](const Candidate& c) { return !isAllowed(c.node); });
  std::vector<Candidate> beside;
  for (const Candidate& candidate : all) {
    bool touches = false;
    mesh.edges().forEachOutgoing(candidate.slot, [&](HalfEdge h) {
      const VertexSlot neighbour = mesh.edges().destination(h);
      touches = touches || (neighbour < pixels.size() && pixels[neighbour] > 0);
    });
    if (touches) beside.push_back(candidate);
  }
  return beside.empty() && goal_ == ReceiverGoal::all ? all : beside;
}

// Those that a request up to this level brings along.
void ReceiverWay::addDescendants(Flight& flight, unsigned significance) const {
  const std::span<const PackRecord> records = refined_.pack().records();
  for (size_t next = 0; next < flight.records.size(); ++next)
    for (const RecordIndex child : records[flight.records[next]].children)
      if (child != kNoRecord && records[child].entry.level <= significance)
        flight.records.push_back(child);
}

Result<void> ReceiverWay::send(std::span<const Candidate> chosen) {
  std::vector<Candidate> sorted(chosen.begin(), chosen.end());
  std::sort(sorted.begin(), sorted.end(),
            [](const Candidate& a, const Candidate& b) { return a.id < b.id; });
  Flight flight;
  RecordRequest request;
  uint64_t pixels = 0;
  for (const Candidate& candidate : sorted) {
    flight.records.push_back(refined_.recordOf(candidate.node));
    busy_[candidate.node] = 1;
    request.nodes.push_back(candidate.id);
    request.levels.push_back(static_cast<uint8_t>(refined_.mesh().level(candidate.node)));
    pixels += candidate.pixels;
  }
  const bool isFirst = refined_.mesh().splitsApplied() == 0 && flights_.empty();
  if (isFirst && options_.service != nullptr && options_.allowed.empty()) {
    request.expansion.significance = firstSignificance(request.levels, pixels, kFirstRecords,
                                                       refined_.pack().metadata().maxLevel);
    if (request.expansion.significance) addDescendants(flight, *request.expansion.significance);
  }
  if (options_.service != nullptr) {
    const Result<ExchangeBytes> bytes = options_.service->records(request);
    if (!bytes) return tl::unexpected(bytes.error());
    flight.bytes = *bytes;
  } else {
    flight.bytes.down = flight.records.size();
  }
  flights_.push_back(std::move(flight));
  return {};
}

}  // namespace meshfront::evaluation
