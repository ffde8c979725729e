#include "shared/receiver/exact_source.h"

#include <algorithm>
#include <utility>

#include "shared/receiver/ranking.h"
#include "shared/receiver/record_request.h"

namespace meshfront {
namespace {

constexpr size_t kQueuedBatches = 8;        // ranked ahead, where rankings are used up
constexpr size_t kCompletingBatch = 4'000;  // nothing is ranked any more: fewer, larger requests

}  // namespace

ExactSource::ExactSource(SourceSurroundings surroundings)
    : to_(std::move(surroundings)),
      mesh_(to_.mesh),
      tables_(std::make_shared<const CodeTables>(mesh_.base().tables)),
      budget_(to_.options.limits) {}

ExactSource::~ExactSource() {
  cancelAll();
}

// --- requests ------------------------------------------------------------------------------------

void ExactSource::send(Flight& flight, bool bypassCaches) {
  SpelledSet spelled;
  Result<FetchRequest> http = toFetch(to_.url, to_.revision, *flight.request, &spelled);
  if (!http) {
    // Front nodes are an antichain: only a damaged mesh can get here.
    report({SourceTrouble::Kind::failed, "the request cannot be written: " + http.error().message,
            true});
    return;
  }
  http->bypassCaches = bypassCaches;
  ++to_.statistics.requests;
  to_.statistics.idsRequested += flight.nodes.size();
  to_.statistics.setOctets += spelled.octets;
  flight.id = to_.transport.send(
      std::move(*http),
      recordsInto(to_.inbox, spelled.key, flight.sequence, flight.request, tables_));
}

uint64_t ExactSource::pendingRecords() const {
  uint64_t pending = 0;
  for (const auto& flight : flights_)
    pending += flight->nodes.size() - std::min(flight->nodes.size(), flight->applied);
  return pending;
}

bool ExactSource::hasRoom() const {
  return flights_.size() < windowOf(to_.options);
}

size_t ExactSource::batchSize() const {
  const size_t wished = to_.options.batch > 0 ? to_.options.batch
                        : queueExpansion_     ? kCompletingBatch
                                              : adaptiveBatch(mesh_.splitsApplied());
  uint64_t underWay = 0;
  for (const auto& flight : flights_) underWay += flight->arrival ? 0 : 1;
  const ReceiverStatistics& statistics = to_.statistics;
  const uint64_t allowed = budget_.recordsAllowed(
      statistics.records, statistics.traffic.bytesDown(), pendingRecords(), underWay);
  return static_cast<size_t>(std::min<uint64_t>({wished, batchLimit_, allowed}));
}

void ExactSource::request() {
  while (hasRoom() && !inTrouble()) {
    if (queueNext_ == queue_.size() && to_.progress.completing) refillFromRest();
    const size_t batch = batchSize();
    std::vector<NodeIndex> chosen;
    while (chosen.size() < batch && queueNext_ < queue_.size()) {
      const NodeIndex node = queue_[queueNext_++];
      if (mesh_.isActive(node) && !isBusy(node)) chosen.push_back(node);
    }
    if (chosen.empty()) return;
    std::sort(chosen.begin(), chosen.end(),
              [this](NodeIndex a, NodeIndex b) { return mesh_.id(a) < mesh_.id(b); });
    auto request = std::make_shared<RecordRequest>();
    for (const NodeIndex node : chosen) {
      request->nodes.push_back(mesh_.id(node));
      request->levels.push_back(static_cast<uint8_t>(mesh_.level(node)));
      setBusy(node, true);
    }
    if (!expansionRefused_ && !budget_.limited()) request->expansion.significance = queueExpansion_;
    Flight& flight = *flights_.emplace_back(std::make_unique<Flight>());
    flight.sequence = ++lastSequence_;
    flight.request = std::move(request);
    flight.nodes = std::move(chosen);
    send(flight, false);
  }
}

// What no view asked for, coarse levels first. Descendants that share the level come along
// (Expansion), which saves the round trip for each generation.
void ExactSource::refillFromRest() {
  queue_.clear();
  queueNext_ = 0;
  queueExpansion_.reset();
  // Descendants arrive with a request for their ancestors: one level after the other.
  if (!flights_.empty()) return;
  std::vector<Candidate> rest = allCandidates(mesh_, busy_);
  restExhausted_ = rest.empty();
  if (rest.empty()) return;
  const size_t wanted = kQueuedBatches * kCompletingBatch;
  keepFirst(rest, wanted, RankOrder::significance);
  const size_t decisive = std::min(rest.size(), kCompletingBatch / 2) - 1;
  queueExpansion_ = rest[decisive].level;
  for (const Candidate& candidate : rest)
    if (candidate.level <= *queueExpansion_) queue_.push_back(candidate.node);
}

void ExactSource::rank(std::span<const uint32_t> pixels) {
  markUnapplied();
  std::vector<Candidate> visible = visibleCandidates(mesh_, pixels, busy_);
  to_.progress.see(visible.size(), idle(), to_.options, to_.statistics);
  if (to_.progress.completing) return;
  queueExpansion_.reset();
  const size_t ahead = to_.options.freshRanking ? windowOf(to_.options) : kQueuedBatches;
  keepFirst(visible, ahead * std::max<size_t>(batchSize(), 1), to_.options.order);
  queue_.clear();
  queueNext_ = 0;
  for (const Candidate& candidate : visible) queue_.push_back(candidate.node);
}

bool ExactSource::wantsRanking() const {
  return hasRoom() && !to_.progress.completing && !to_.progress.ranked &&
         queueNext_ == queue_.size();
}

// --- answers -------------------------------------------------------------------------------------

void ExactSource::take(Arrival arrival) {
  auto* records = std::get_if<RecordsArrival>(&arrival);
  if (records == nullptr) return;
  // Flights given up meanwhile are not found.
  for (const auto& flight : flights_)
    if (flight->sequence == records->sequence) {
      flight->arrival = std::move(*records);
      return;
    }
}

bool ExactSource::canApply() const {
  return !flights_.empty() && flights_.front()->arrival;
}

bool ExactSource::apply(size_t maxSplits) {
  if (!canApply()) return false;
  Flight& flight = *flights_.front();
  const RecordsArrival& arrival = *flight.arrival;
  if (arrival.response.status != 200) {
    refuseFirstFlight();
    return false;
  }
  if (!arrival.entries) {
    rejectFirstFlight(arrival.entries.error().message);
    return false;
  }
  for (; flight.applied < arrival.entries->size(); ++flight.applied) {
    if (maxSplits == 0) return false;
    --maxSplits;
    const RecordEntry& entry = (*arrival.entries)[flight.applied];
    const std::optional<NodeIndex> node = mesh_.find(entry.id);
    if (!node || (!mesh_.isActive(*node) && !mesh_.hasRecord(*node))) {
      rejectFirstFlight("it holds the record of a node that is not on the front");
      return false;
    }
    setBusy(*node, false);
    if (!mesh_.isActive(*node)) continue;  // came with another answer
    const Result<void> split =
        mesh_.split(*node, arrival.response.body, entry.bitOffset, entry.bitLength);
    if (!split) {
      rejectFirstFlight(split.error().message);
      return false;
    }
    ++to_.statistics.records;
  }
  finishFirstFlight();
  return true;
}

void ExactSource::finishFirstFlight() {
  const RecordsArrival& arrival = *flights_.front()->arrival;
  ++to_.statistics.answers;
  malformedInRow_ = 0;
  budget_.observeAnswer(arrival.response.traffic.headerBytesDown,
                        arrival.response.traffic.bodyBytesDown, arrival.entries->size());
  dropFirstFlight();
  if (to_.options.freshRanking && !queueExpansion_) {
    queue_.clear();
    queueNext_ = 0;
  }
}

void ExactSource::refuseFirstFlight() {
  const Flight& flight = *flights_.front();
  const FetchResponse response = std::move(flights_.front()->arrival->response);
  const bool expanded = !flight.request->expansion.none();
  const size_t nodes = flight.nodes.size();
  const bool tooMuch = response.status == 413 || response.status == 414;
  dropFirstFlight();
  if (tooMuch && expanded) {
    expansionRefused_ = true;
  } else if (tooMuch && nodes > 1) {
    batchLimit_ = nodes / 2;
  } else {
    reportRefusal(to_.url, response, "a request for records");
  }
}

// Sends the request again, past every cache, for the nodes that are still unsplit; a second damaged
// answer in a row ends it.
void ExactSource::rejectFirstFlight(const std::string& problem) {
  ++to_.statistics.malformed;
  if (++malformedInRow_ > 1) {
    report({SourceTrouble::Kind::damaged,
            "an answer is damaged, and so is its repetition: " + problem});
    return;
  }
  Flight& flight = *flights_.front();
  if (flight.arrival->entries) {  // undo markUnapplied()
    for (const RecordEntry& entry : *flight.arrival->entries)
      if (const std::optional<NodeIndex> node = mesh_.find(entry.id)) setBusy(*node, false);
  }
  auto request = std::make_shared<RecordRequest>();
  std::vector<NodeIndex> nodes;
  for (const NodeIndex node : flight.nodes) {
    setBusy(node, mesh_.isActive(node));
    if (!mesh_.isActive(node)) continue;
    nodes.push_back(node);
    request->nodes.push_back(mesh_.id(node));
    request->levels.push_back(static_cast<uint8_t>(mesh_.level(node)));
  }
  if (nodes.empty()) {
    dropFirstFlight();
    return;
  }
  request->expansion = flight.request->expansion;
  flight.request = std::move(request);
  flight.nodes = std::move(nodes);
  flight.arrival.reset();
  flight.applied = 0;
  flight.sequence = ++lastSequence_;
  send(flight, true);
}

void ExactSource::dropFirstFlight() {
  for (const NodeIndex node : flights_.front()->nodes) setBusy(node, false);
  flights_.pop_front();
  to_.progress.ranked = false;
}

// An answer that is applied piece by piece may hold the records of nodes that its own pieces bring
// in; a ranking in between must not ask for them.
void ExactSource::markUnapplied() {
  if (flights_.empty()) return;
  const Flight& flight = *flights_.front();
  if (!flight.arrival || !flight.arrival->entries || flight.applied == 0) return;
  const std::vector<RecordEntry>& entries = *flight.arrival->entries;
  for (size_t i = flight.applied; i < entries.size(); ++i) {
    const std::optional<NodeIndex> node = mesh_.find(entries[i].id);
    if (node && mesh_.isActive(*node)) setBusy(*node, true);
  }
}

// --- state ---------------------------------------------------------------------------------------

void ExactSource::cancelAll() {
  for (const auto& flight : flights_)
    if (!flight->arrival) to_.transport.cancel(flight->id);
}

void ExactSource::giveUp() {
  cancelAll();
  flights_.clear();
  std::fill(busy_.begin(), busy_.end(), uint8_t{0});
  queue_.clear();
  queueNext_ = 0;
  queueExpansion_.reset();
  malformedInRow_ = 0;
}

bool ExactSource::isBusy(NodeIndex node) const {
  return node < busy_.size() && busy_[node] != 0;
}

void ExactSource::setBusy(NodeIndex node, bool busy) {
  if (node >= busy_.size()) {
    if (!busy) return;
    busy_.resize(std::max<size_t>(size_t{node} + 1, busy_.size() * 2));
  }
  busy_[node] = busy ? 1 : 0;
}

}  // namespace meshfront
