// The way of a cycle:
//   rank        fresh pixel counts -> queue_ of nodes, best first
//   fillWindow  queue_ -> flights_, one request each, their nodes busy
//   (transport) an answer is parsed on its thread and put into the inbox
//   advance     inbox -> the flight it belongs to -> applied in the order of the requests
// Flights are applied in order although answers may overtake each other: the mesh after n answers,
// and so every later request, is then the same for everybody who looks at the same view.
#include "shared/receiver/receiver.h"

#include <algorithm>
#include <utility>

#include "shared/receiver/inbox.h"
#include "shared/receiver/problem_details.h"

namespace meshfront {
namespace {

constexpr size_t kMaxMetadataBytes = 1 << 20;
constexpr uint64_t kMaxBaseBytes = uint64_t{1} << 30;
constexpr unsigned kMaxNotFoundInRow = 3;
constexpr size_t kQueuedBatches = 8;        // ranked ahead, where rankings are used up
constexpr size_t kCompletingBatch = 4'000;  // nothing is ranked any more: fewer, larger requests

}  // namespace

struct Receiver::Flight {
  uint64_t sequence = 0;
  FetchId id = 0;
  std::shared_ptr<const RecordRequest> request;
  std::vector<NodeIndex> nodes;           // of the request, in its order
  std::optional<RecordsArrival> arrival;  // else under way
  size_t applied = 0;                     // entries of the arrival
};

const char* stateName(ReceiverState state) {
  switch (state) {
    case ReceiverState::connecting:
      return "connecting";
    case ReceiverState::refining:
      return "refining";
    case ReceiverState::settled:
      return "settled";
    case ReceiverState::complete:
      return "complete";
    case ReceiverState::limitReached:
      return "limit reached";
    case ReceiverState::degraded:
      return "degraded";
  }
  return "unknown";
}

Receiver::Receiver(MeshUrl url, ReceiverOptions options, Transport& transport)
    : url_(std::move(url)),
      options_(std::move(options)),
      transport_(transport),
      inbox_(std::make_shared<Inbox>(options_.onArrival)),
      budget_(options_.limits) {
  requestMetadata(false);
}

Receiver::~Receiver() {
  transport_.cancel(setupRequest_);
  for (const auto& flight : flights_)
    if (!flight->arrival) transport_.cancel(flight->id);
  inbox_->close();
}

bool Receiver::isAtWork() const {
  return state_ == ReceiverState::connecting || state_ == ReceiverState::refining;
}

// --- requests ------------------------------------------------------------------------------------

void Receiver::requestMetadata(bool bypassCaches) {
  FetchRequest request;
  request.url = url_.metadata();
  request.maxBodyBytes = kMaxMetadataBytes;
  request.bypassCaches = bypassCaches;
  awaitingMetadata_ = true;
  setupRequest_ = transport_.send(std::move(request), metadataInto(inbox_));
}

void Receiver::requestBase() {
  FetchRequest request;
  request.url = url_.base(metadata_->revision);
  request.maxBodyBytes = static_cast<size_t>(std::min(metadata_->baseBytes, kMaxBaseBytes));
  setupRequest_ = transport_.send(std::move(request), baseInto(inbox_));
}

void Receiver::send(Flight& flight, bool bypassCaches) {
  size_t setOctets = 0;
  Result<FetchRequest> http = toFetch(url_, metadata_->revision, *flight.request, &setOctets);
  if (!http) {
    // Front nodes are an antichain: only a damaged mesh can get here.
    degrade("the request cannot be written: " + http.error().message, true);
    return;
  }
  http->bypassCaches = bypassCaches;
  ++statistics_.requests;
  statistics_.idsRequested += flight.nodes.size();
  statistics_.setOctets += setOctets;
  flight.id = transport_.send(std::move(*http),
                              recordsInto(inbox_, flight.sequence, flight.request, tables_));
}

uint64_t Receiver::pendingRecords() const {
  uint64_t pending = 0;
  for (const auto& flight : flights_)
    pending += flight->nodes.size() - std::min(flight->nodes.size(), flight->applied);
  return pending;
}

bool Receiver::mayRequest() const {
  return mesh_ && !awaitingMetadata_ && state_ != ReceiverState::degraded &&
         flights_.size() < std::max(1U, options_.window);
}

size_t Receiver::batchSize() const {
  const size_t wished = options_.batch > 0 ? options_.batch
                        : queueExpansion_  ? kCompletingBatch
                                           : adaptiveBatch(mesh_->splitsApplied());
  uint64_t underWay = 0;
  for (const auto& flight : flights_) underWay += flight->arrival ? 0 : 1;
  const uint64_t allowed = budget_.recordsAllowed(
      statistics_.records, statistics_.traffic.bytesDown(), pendingRecords(), underWay);
  return static_cast<size_t>(std::min<uint64_t>({wished, batchLimit_, allowed}));
}

void Receiver::fillWindow() {
  while (mayRequest()) {
    if (queueNext_ == queue_.size() && completing_) refillFromRest();
    const size_t batch = batchSize();
    std::vector<NodeIndex> chosen;
    while (chosen.size() < batch && queueNext_ < queue_.size()) {
      const NodeIndex node = queue_[queueNext_++];
      if (mesh_->isActive(node) && !isBusy(node)) chosen.push_back(node);
    }
    if (chosen.empty()) return;
    std::sort(chosen.begin(), chosen.end(),
              [this](NodeIndex a, NodeIndex b) { return mesh_->id(a) < mesh_->id(b); });
    auto request = std::make_shared<RecordRequest>();
    for (const NodeIndex node : chosen) {
      request->nodes.push_back(mesh_->id(node));
      request->levels.push_back(static_cast<uint8_t>(mesh_->level(node)));
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
void Receiver::refillFromRest() {
  queue_.clear();
  queueNext_ = 0;
  queueExpansion_.reset();
  // Descendants arrive with a request for their ancestors: one level after the other.
  if (!flights_.empty()) return;
  std::vector<Candidate> rest = allCandidates(*mesh_, busy_);
  restExhausted_ = rest.empty();
  if (rest.empty()) return;
  const size_t wanted = kQueuedBatches * kCompletingBatch;
  keepFirst(rest, wanted, RankOrder::significance);
  const size_t decisive = std::min(rest.size(), kCompletingBatch / 2) - 1;
  queueExpansion_ = rest[decisive].level;
  for (const Candidate& candidate : rest)
    if (candidate.level <= *queueExpansion_) queue_.push_back(candidate.node);
}

void Receiver::rank(std::span<const uint32_t> pixels) {
  if (!mesh_ || state_ == ReceiverState::degraded) return;
  markUnapplied();
  std::vector<Candidate> visible = visibleCandidates(*mesh_, pixels, busy_);
  visibleCount_ = visible.size();
  settledView_ = visible.empty() && flights_.empty();
  if (settledView_) {
    if (!statistics_.recordsWhenSettled) statistics_.recordsWhenSettled = statistics_.records;
    if (options_.goal == ReceiverOptions::Goal::complete) completing_ = true;
  }
  if (!visible.empty()) completing_ = false;
  ranked_ = true;
  if (!completing_) {
    queueExpansion_.reset();
    const size_t ahead = options_.freshRanking ? options_.window : kQueuedBatches;
    keepFirst(visible, std::max<size_t>(ahead, 1) * std::max<size_t>(batchSize(), 1),
              options_.order);
    queue_.clear();
    queueNext_ = 0;
    for (const Candidate& candidate : visible) queue_.push_back(candidate.node);
  }
  fillWindow();
  updateState();
}

bool Receiver::wantsRanking() const {
  return mayRequest() && !completing_ && !ranked_ && queueNext_ == queue_.size();
}

// --- answers -------------------------------------------------------------------------------------

bool Receiver::waitForArrival(std::chrono::milliseconds timeout) const {
  if (!flights_.empty() && flights_.front()->arrival) return true;
  return inbox_->wait(timeout);
}

bool Receiver::advance(size_t maxSplits) {
  for (Arrival& arrival : inbox_->takeAll()) {
    if (auto* metadata = std::get_if<MetadataArrival>(&arrival)) {
      statistics_.traffic += metadata->response.traffic;
      takeMetadata(std::move(*metadata));
    } else if (auto* base = std::get_if<BaseArrival>(&arrival)) {
      statistics_.traffic += base->response.traffic;
      takeBase(std::move(*base));
    } else if (auto* records = std::get_if<RecordsArrival>(&arrival)) {
      const Traffic& traffic = records->response.traffic;
      statistics_.traffic += traffic;
      statistics_.requestBytesUp += traffic.bytesUp;
      statistics_.answerBytesDown += traffic.bodyBytesDown;
      // Flights given up meanwhile are not found.
      for (const auto& flight : flights_)
        if (flight->sequence == records->sequence) flight->arrival = std::move(*records);
    }
  }
  bool finished = false;
  const bool rankingFirst = options_.freshRanking && wantsRanking();
  if (!rankingFirst && !flights_.empty() && flights_.front()->arrival)
    finished = applyFirstFlight(maxSplits);
  if (finished && options_.freshRanking && !queueExpansion_) {
    queue_.clear();
    queueNext_ = 0;
  }
  fillWindow();
  updateState();
  return finished;
}

void Receiver::takeMetadata(MetadataArrival arrival) {
  awaitingMetadata_ = false;
  const FetchResponse& response = arrival.response;
  if (response.status == 0) {
    degrade(response.error.message, false);
  } else if (response.status == 404) {
    degrade("there is no mesh '" + url_.name + "' at " + url_.origin + url_.prefix +
                " (the catalogue is /v1/meshes)",
            false);
  } else if (response.status != 200) {
    degrade(url_.origin + " refuses the metadata: " + describeRefusal(response), false);
  } else if (!arrival.metadata) {
    degrade(
        url_.metadata() + " is no mesh of the v1 interface: " + arrival.metadata.error().message,
        true);
  } else if (mesh_ && metadata_->revision != arrival.metadata->revision) {
    degrade("the mesh was published anew: revision " + metadata_->revision + " is now " +
                arrival.metadata->revision + "; connect again to see it",
            true);
  } else {
    metadata_ = std::move(*arrival.metadata);
    if (!mesh_) requestBase();
  }
}

void Receiver::takeBase(BaseArrival arrival) {
  if (mesh_) return;  // asked for twice, over a resume()
  const FetchResponse& response = arrival.response;
  if (response.status == 0) {
    degrade(response.error.message, false);
  } else if (response.status == 404) {
    revisionNotFound();
  } else if (response.status != 200) {
    degrade(url_.origin + " refuses the base mesh: " + describeRefusal(response), false);
  } else if (!arrival.mesh) {
    ++statistics_.malformed;
    degrade("the base mesh is damaged or of another version: " + arrival.mesh.error().message,
            true);
  } else {
    notFoundInRow_ = 0;
    mesh_ = std::make_unique<SelectivelyRefinedMesh>(std::move(*arrival.mesh));
    tables_ = std::make_shared<const CodeTables>(mesh_->base().tables);
  }
}

bool Receiver::applyFirstFlight(size_t& maxSplits) {
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
    const std::optional<NodeIndex> node = mesh_->find(entry.id);
    if (!node || (!mesh_->isActive(*node) && !mesh_->hasRecord(*node))) {
      rejectFirstFlight("it holds the record of a node that is not on the front");
      return false;
    }
    setBusy(*node, false);
    if (!mesh_->isActive(*node)) continue;  // came with another answer
    const Result<void> split =
        mesh_->split(*node, arrival.response.body, entry.bitOffset, entry.bitLength);
    if (!split) {
      rejectFirstFlight(split.error().message);
      return false;
    }
    ++statistics_.records;
  }
  finishFirstFlight();
  return true;
}

void Receiver::finishFirstFlight() {
  const RecordsArrival& arrival = *flights_.front()->arrival;
  ++statistics_.answers;
  malformedInRow_ = 0;
  notFoundInRow_ = 0;
  budget_.observeAnswer(arrival.response.traffic.headerBytesDown,
                        arrival.response.traffic.bodyBytesDown, arrival.entries->size());
  dropFirstFlight();
}

void Receiver::refuseFirstFlight() {
  const Flight& flight = *flights_.front();
  const FetchResponse response = std::move(flights_.front()->arrival->response);
  const bool expanded = !flight.request->expansion.none();
  const size_t nodes = flight.nodes.size();
  if (response.status == 0) {
    degrade(response.error.message, false);
    return;
  }
  dropFirstFlight();
  if (response.status == 404) {
    revisionNotFound();
  } else if ((response.status == 413 || response.status == 414) && (expanded || nodes > 1)) {
    if (expanded) {
      expansionRefused_ = true;
    } else {
      batchLimit_ = nodes / 2;
    }
  } else {
    degrade(url_.origin + " refuses a request for records: " + describeRefusal(response), false);
  }
}

// Sends the request again, past every cache, for the nodes that are still unsplit; a second damaged
// answer in a row ends it.
void Receiver::rejectFirstFlight(const std::string& problem) {
  ++statistics_.malformed;
  if (++malformedInRow_ > 1) {
    degrade("an answer is damaged, and so is its repetition: " + problem, true);
    return;
  }
  Flight& flight = *flights_.front();
  if (flight.arrival->entries) {  // undo markUnapplied()
    for (const RecordEntry& entry : *flight.arrival->entries)
      if (const std::optional<NodeIndex> node = mesh_->find(entry.id)) setBusy(*node, false);
  }
  auto request = std::make_shared<RecordRequest>();
  std::vector<NodeIndex> nodes;
  for (const NodeIndex node : flight.nodes) {
    setBusy(node, mesh_->isActive(node));
    if (!mesh_->isActive(node)) continue;
    nodes.push_back(node);
    request->nodes.push_back(mesh_->id(node));
    request->levels.push_back(static_cast<uint8_t>(mesh_->level(node)));
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

void Receiver::dropFirstFlight() {
  for (const NodeIndex node : flights_.front()->nodes) setBusy(node, false);
  flights_.pop_front();
  ranked_ = false;
}

// The server no longer has our revision: see which one it has.
void Receiver::revisionNotFound() {
  if (awaitingMetadata_) return;
  if (++notFoundInRow_ > kMaxNotFoundInRow) {
    degrade(url_.origin + " names revision " + metadata_->revision + " and has none of its records",
            false);
    return;
  }
  requestMetadata(true);
}

// An answer that is applied piece by piece may hold the records of nodes that its own pieces bring
// in; a ranking in between must not ask for them.
void Receiver::markUnapplied() {
  if (flights_.empty()) return;
  const Flight& flight = *flights_.front();
  if (!flight.arrival || !flight.arrival->entries || flight.applied == 0) return;
  const std::vector<RecordEntry>& entries = *flight.arrival->entries;
  for (size_t i = flight.applied; i < entries.size(); ++i) {
    const std::optional<NodeIndex> node = mesh_->find(entries[i].id);
    if (node && mesh_->isActive(*node)) setBusy(*node, true);
  }
}

// --- state ---------------------------------------------------------------------------------------

bool Receiver::isBusy(NodeIndex node) const {
  return node < busy_.size() && busy_[node] != 0;
}

void Receiver::setBusy(NodeIndex node, bool busy) {
  if (node >= busy_.size()) {
    if (!busy) return;
    busy_.resize(std::max<size_t>(size_t{node} + 1, busy_.size() * 2));
  }
  busy_[node] = busy ? 1 : 0;
}

void Receiver::updateState() {
  if (state_ == ReceiverState::degraded) return;
  if (!mesh_) {
    state_ = ReceiverState::connecting;
  } else if (mesh_->complete()) {
    state_ = ReceiverState::complete;
  } else if (settledView_ && flights_.empty() && !completing_) {
    state_ = ReceiverState::settled;
  } else if (flights_.empty() && !awaitingMetadata_ && batchSize() == 0) {
    state_ = ReceiverState::limitReached;
  } else if (flights_.empty() && restExhausted_) {
    degrade("the base mesh promises " + std::to_string(mesh_->splitCount()) +
                " records, and only " + std::to_string(mesh_->splitsApplied()) + " exist",
            true);
  } else {
    state_ = ReceiverState::refining;
  }
}

void Receiver::degrade(std::string reason, bool final) {
  for (const auto& flight : flights_)
    if (!flight->arrival) transport_.cancel(flight->id);
  flights_.clear();
  std::fill(busy_.begin(), busy_.end(), uint8_t{0});
  queue_.clear();
  queueNext_ = 0;
  queueExpansion_.reset();
  awaitingMetadata_ = false;
  state_ = ReceiverState::degraded;
  reason_ = std::move(reason);
  final_ = final;
}

bool Receiver::resume() {
  if (state_ != ReceiverState::degraded || final_) return false;
  state_ = mesh_ ? ReceiverState::refining : ReceiverState::connecting;
  reason_.clear();
  notFoundInRow_ = 0;
  settledView_ = false;
  ranked_ = false;
  // Always anew: the server may have come back with another revision.
  requestMetadata(true);
  return true;
}

}  // namespace meshfront
