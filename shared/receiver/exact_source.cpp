#include "shared/receiver/exact_source.h"

#include <algorithm>
#include <utility>

#include "shared/receiver/cache_verdict.h"
#include "shared/receiver/ranking.h"
#include "shared/receiver/record_request.h"

namespace meshfront {

ExactSource::ExactSource(SourceSurroundings surroundings)
    : to_(std::move(surroundings)),
      mesh_(to_.mesh),
      tables_(std::make_shared<const CodeTables>(mesh_.base().tables)),
      local_(to_),
      plan_(to_.options.order),
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
  http->received = to_.received;
  ++to_.statistics.requests;
  to_.statistics.idsRequested += flight.nodes.size();
  to_.statistics.setOctets += spelled.octets;
  flight.id = to_.transport.send(
      std::move(*http),
      recordsInto(to_.inbox, spelled.key, flight.sequence, flight.request, tables_));
}

uint64_t ExactSource::pendingRecords() const {
  uint64_t pending = 0;
  for (const auto& flight : flights_) {
    const uint64_t records = flight->arrival && flight->arrival->entries
                                 ? flight->arrival->entries->size()
                                 : flight->mostRecords;
    pending += records - std::min<uint64_t>(records, flight->applied);
  }
  return pending;
}

bool ExactSource::hasRoom() const {
  return flights_.size() < windowNow(to_);
}

size_t ExactSource::batchSize() const {
  const size_t wished = to_.options.batch > 0 ? to_.options.batch
                        : queueExpansion_     ? kCompletingBatch
                                              : adaptiveBatch(mesh_.splitsApplied());
  uint64_t underWay = 0;
  for (const auto& flight : flights_) underWay += flight->arrival ? 0 : 1;
  const ReceiverStatistics& statistics = to_.statistics;
  const uint64_t pending = pendingRecords();
  const uint64_t allowed =
      budget_.recordsAllowed(statistics.records, statistics.traffic.bytesDown(), pending, underWay);
  return static_cast<size_t>(
      std::min<uint64_t>({wished, batchLimit_, allowed, to_.allowance.leftBeside(pending)}));
}

void ExactSource::request() {
  // What is at hand changes the wishes, and soon.
  if (planWaits() && plansInRow_ < kMostPlansInRow) return;
  while (hasRoom() && !inTrouble()) {
    if (queueNext_ == queue_.size() && !aheadQueue_.empty() && to_.progress.visible == 0) {
      requestAhead();
      return;
    }
    if (queueNext_ == queue_.size() && to_.progress.completing) refillFromRest();
    std::vector<Wish> chosen = takeBatch(queue_, queueNext_);
    if (chosen.empty()) return;
    sendBatch(std::move(chosen), false);
  }
}

void ExactSource::requestAhead() {
  if (!flights_.empty()) return;
  size_t next = 0;
  std::vector<Wish> chosen = takeBatch(aheadQueue_, next);
  aheadQueue_.erase(aheadQueue_.begin(), aheadQueue_.begin() + static_cast<ptrdiff_t>(next));
  if (chosen.empty()) {
    aheadQueue_.clear();
  } else {
    sendBatch(std::move(chosen), true);
  }
}

std::vector<ExactSource::Wish> ExactSource::takeBatch(std::vector<Wish>& from, size_t& next) const {
  const size_t batch = batchSize();
  std::vector<Wish> chosen;
  while (chosen.size() < batch && next < from.size()) {
    const Wish wish = from[next++];
    if (mesh_.isActive(wish.node) && !mesh_.hasRecord(wish.node) && !isBusy(wish.node))
      chosen.push_back(wish);
  }
  return chosen;
}

void ExactSource::sendBatch(std::vector<Wish> chosen, bool ahead) {
  auto request = std::make_shared<RecordRequest>();
  request->expansion = expansionFor(chosen);
  std::sort(chosen.begin(), chosen.end(),
            [this](const Wish& a, const Wish& b) { return mesh_.id(a.node) < mesh_.id(b.node); });
  Flight& flight = *flights_.emplace_back(std::make_unique<Flight>());
  for (const Wish& wish : chosen) {
    request->nodes.push_back(mesh_.id(wish.node));
    request->levels.push_back(static_cast<uint8_t>(mesh_.level(wish.node)));
    flight.nodes.push_back(wish.node);
    setBusy(wish.node, true);
    mesh_.setPinned(wish.node, true);
  }
  to_.statistics.expanded += request->expansion.none() || queueExpansion_ ? 0 : 1;
  flight.mostRecords = queueExpansion_ ? chosen.size() : likelyRecords(*request);
  flight.sequence = ++lastSequence_;
  flight.request = std::move(request);
  flight.ahead = ahead;
  send(flight, false);
}

Expansion ExactSource::expansionFor(std::vector<Wish>& chosen) const {
  Expansion expansion;
  if (expansionRefused_ || budget_.limited()) return expansion;
  // An answer of unknown length must not run into the allowance.
  if (queueExpansion_ && !to_.allowance.limited()) expansion.significance = queueExpansion_;
  if (!queueExpansion_) expansion.significance = significanceAtFirst(chosen);
  if (!expansion.significance && !queueExpansion_) expansion.levels = levelsByNeed(chosen);
  return expansion;
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
  return planWaits() || (!flights_.empty() && flights_.front()->arrival);
}

bool ExactSource::apply(size_t maxSplits) {
  if (!canApply()) return false;
  if (planWaits()) return applyPlan(maxSplits);
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
    if (!applyEntry(flight, (*arrival.entries)[flight.applied])) return false;
  }
  finishFirstFlight();
  return true;
}

// What is at hand, and of what comes out of it as much as the counts tell to be seen.
bool ExactSource::applyPlan(size_t maxSplits) {
  while (planWaits()) {
    if (maxSplits == 0) return false;
    const Candidate candidate = plan_.takeFirst();
    if (!mesh_.isActive(candidate.node)) continue;
    --maxSplits;
    if (!local_.split(candidate.node)) continue;  // damaged: to be asked for again
    to_.allowance.use();
    const NodeIndex left = mesh_.leftChild(candidate.node);
    for (const NodeIndex node : {left, left + 1}) {
      if (mesh_.isLeaf(node) || isBusy(node) || !local_.has(node)) continue;
      const Candidate child = childCandidate(mesh_, candidate, node);
      if (child.pixels > 0 || to_.progress.completing) plan_.add(child);
    }
  }
  plan_.clear();
  to_.progress.ranked = false;
  return true;
}

// False: the answer is no good.
bool ExactSource::applyEntry(Flight& flight, const RecordEntry& entry) {
  const std::vector<uint8_t>& bytes = flight.arrival->response.body;
  const std::optional<NodeIndex> node = mesh_.find(entry.id);
  if (node) setBusy(*node, false);
  // A node that nobody has met is the descendant of one that has been collapsed since it was asked
  // for.
  if (node && mesh_.isActive(*node) && to_.allowance.left() > 0) {
    const Result<void> split = mesh_.split(*node, bytes, entry.bitOffset, entry.bitLength);
    if (!split) {
      rejectFirstFlight(split.error().message);
      return false;
    }
    to_.allowance.use();
    ++to_.statistics.records;
  } else if (node && !mesh_.hasRecord(*node)) {
    if (mesh_.keepRecord(*node, bytes, entry.bitOffset, entry.bitLength)) ++to_.statistics.records;
  }
  local_.keep(entry.id, bytes, entry.bitOffset, entry.bitLength);
  return true;
}

void ExactSource::finishFirstFlight() {
  const RecordsArrival& arrival = *flights_.front()->arrival;
  ++to_.statistics.answers;
  malformedInRow_ = 0;
  budget_.observeAnswer(arrival.response.traffic.headerBytesDown,
                        arrival.response.traffic.bodyBytesDown, arrival.entries->size());
  to_.statistics.answersFromCaches += cameFromCache(arrival.response) ? 1 : 0;
  dropFlight(flights_.begin());
  if (to_.options.freshRanking && !queueExpansion_) forgetQueue();
}

void ExactSource::refuseFirstFlight() {
  const Flight& flight = *flights_.front();
  const FetchResponse response = std::move(flights_.front()->arrival->response);
  const bool expanded = !flight.request->expansion.none();
  const size_t nodes = flight.nodes.size();
  const bool tooMuch = response.status == 413 || response.status == 414;
  dropFlight(flights_.begin());
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
    const bool wanted = mesh_.isActive(node) && !mesh_.hasRecord(node);
    setBusy(node, wanted);
    mesh_.setPinned(node, wanted);
    if (!wanted) continue;
    nodes.push_back(node);
    request->nodes.push_back(mesh_.id(node));
    request->levels.push_back(static_cast<uint8_t>(mesh_.level(node)));
  }
  if (nodes.empty()) {
    flight.nodes.clear();
    dropFlight(flights_.begin());
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

void ExactSource::dropFlight(std::deque<std::unique_ptr<Flight>>::iterator flight) {
  for (const NodeIndex node : (*flight)->nodes) {
    setBusy(node, false);
    mesh_.setPinned(node, false);
  }
  flights_.erase(flight);
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
  while (!flights_.empty()) dropFlight(flights_.begin());
  std::fill(busy_.begin(), busy_.end(), uint8_t{0});
  forgetQueue();
  aheadQueue_.clear();
  malformedInRow_ = 0;
}

void ExactSource::forgot(std::span<const NodeId>) {
  plan_.clear();
  forgetQueue();
  aheadQueue_.clear();
  std::fill(busy_.begin(), busy_.end(), uint8_t{0});
  for (const auto& flight : flights_)  // pinned: these are what they were
    for (const NodeIndex node : flight->nodes) setBusy(node, true);
  to_.progress.ranked = false;
}

bool ExactSource::idle() const {
  if (planWaits()) return false;
  return std::all_of(flights_.begin(), flights_.end(),
                     [](const auto& flight) { return flight->ahead; });
}

bool ExactSource::isFetching() const {
  return std::any_of(flights_.begin(), flights_.end(),
                     [](const auto& flight) { return !flight->arrival; });
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
