#include "shared/receiver/chunk_source.h"

#include <algorithm>
#include <utility>

#include "shared/receiver/cache_verdict.h"
#include "shared/receiver/disk_cache.h"
#include "shared/receiver/ranking.h"
#include "shared/store/entity_tag.h"

namespace meshfront {
namespace {

constexpr size_t kMaxChunkBytes = size_t{512} << 10;  // 512 records are about 2 KB
constexpr uint64_t kMaxIndexBytes = uint64_t{64} << 20;
constexpr uint64_t kIndexBytesPerChunk = 18;  // at most: a tree's number and a path
constexpr uint64_t kIndexBytesBeside = 1'024;
constexpr double kLongerThanMean = 1.25;

}  // namespace

ChunkSource::ChunkSource(SourceSurroundings surroundings)
    : to_(std::move(surroundings)),
      mesh_(to_.mesh),
      tables_(std::make_shared<const CodeTables>(mesh_.base().tables)),
      budget_(to_.options.limits),
      local_(to_),
      ready_(to_.options.order) {
  if (mesh_.splitCount() > 0) {
    // A full one; the coarse ones, which come first, have longer records than most.
    const double perRecord =
        static_cast<double>(to_.chunkBytes) / static_cast<double>(mesh_.splitCount());
    const double full = kLongerThanMean * kRecordsPerChunk * perRecord;
    longestChunk_ = static_cast<uint64_t>(
        std::min({full, static_cast<double>(to_.chunkBytes), static_cast<double>(kMaxChunkBytes)}));
  }
  if (to_.cache == nullptr) return;
  if (const auto document = to_.cache->chunkIndex())
    if (Result<ChunkIndex> index = decodeChunkIndex(*document)) adoptIndex(std::move(*index));
}

ChunkSource::~ChunkSource() {
  cancelAll();
}

// --- the index -----------------------------------------------------------------------------------

void ChunkSource::requestIndex(bool bypassCaches) {
  FetchRequest request;
  request.url = to_.url.chunkIndex(to_.revision);
  const uint64_t chunks = std::min(to_.chunkCount, kMaxIndexBytes / kIndexBytesPerChunk);
  request.maxBodyBytes = kIndexBytesBeside + chunks * kIndexBytesPerChunk;
  request.bypassCaches = bypassCaches;
  request.received = to_.received;
  indexRequest_ = to_.transport.send(
      std::move(request), chunkIndexInto(to_.inbox, resourceKey(to_.revision, "chunks")));
}

void ChunkSource::takeIndex(ChunkIndexArrival arrival) {
  indexRequest_ = 0;
  to_.progress.ranked = false;
  if (index_) return;  // asked for twice, over a resume()
  if (arrival.response.status != 200) {
    reportRefusal(to_.url, arrival.response, "the chunk index");
    return;
  }
  if (!arrival.index) {
    ++to_.statistics.malformed;
    if (indexRejected_) {
      report(
          {SourceTrouble::Kind::damaged, "the chunk index is damaged, and so is its repetition: " +
                                             arrival.index.error().message});
      return;
    }
    indexRejected_ = true;
    requestIndex(true);
    return;
  }
  if (to_.cache != nullptr) to_.cache->keepChunkIndex(arrival.response.body);
  adoptIndex(std::move(*arrival.index));
}

void ChunkSource::adoptIndex(ChunkIndex index) {
  index_ = std::move(index);
  for (size_t band = 0; band < index_->firstNodes.size(); ++band) {
    for (const NodeId& first : index_->firstNodes[band]) {
      firstNodes_.push_back(first);
      bands_.push_back(static_cast<uint8_t>(band));
    }
  }
  const auto count = static_cast<uint32_t>(firstNodes_.size());
  held_ = HeldChunks(count);
  underWay_.assign(count, 0);
  rejected_.assign(count, 0);
}

std::optional<uint32_t> ChunkSource::chunkOf(NodeIndex node) {
  const std::optional<uint32_t> chunk = index_->find(mesh_.id(node), mesh_.level(node));
  if (!chunk) {
    report({SourceTrouble::Kind::failed,
            "the chunk index names no chunk for a record that the mesh needs", true});
  }
  return chunk;
}

// --- requests -----------------------------------------------------------------------------------

bool ChunkSource::hasRoom() const {
  return flights_.size() < windowNow(to_);
}

bool ChunkSource::wantsRanking() const {
  if (!index_ && to_.cache == nullptr) return false;
  if (to_.progress.completing || to_.progress.ranked || readyWaits()) return false;
  return plansInRow_ > 0 || (hasRoom() && queueNext_ == queue_.size());
}

// Limits let one more chunk in.
bool ChunkSource::mayAsk() const {
  uint64_t pending = 0;
  for (const Flight& flight : flights_) pending += flight.arrival ? 0 : 1;
  if (to_.allowance.limited()) {
    const auto expected = static_cast<uint64_t>(
        std::count_if(waiting_.begin(), waiting_.end(),
                      [this](const Place& place) { return underWay_[place.chunk] != 0; }));
    if (to_.allowance.leftBeside(expected) == 0) return false;
  }
  const ReceiverStatistics& statistics = to_.statistics;
  return budget_.recordsLeft(statistics.records) > 0 &&
         budget_.answerAllowed(statistics.traffic.bytesDown(), pending, longestChunk_);
}

bool ChunkSource::limitReached() const {
  if (budget_.recordsLeft(to_.statistics.records) == 0) return true;
  if (to_.allowance.left() == 0) return true;
  return queueNext_ < queue_.size() && !mayAsk();
}

bool ChunkSource::exhausted() const {
  return restPlanned_ && queueNext_ == queue_.size() && ready_.empty();
}

bool ChunkSource::idle() const {
  if (readyWaits() || indexRequest_ != 0) return false;
  return std::all_of(flights_.begin(), flights_.end(),
                     [](const Flight& flight) { return flight.ahead; });
}

bool ChunkSource::isFetching() const {
  return indexRequest_ != 0 || std::any_of(flights_.begin(), flights_.end(),
                                           [](const Flight& flight) { return !flight.arrival; });
}

void ChunkSource::request() {
  if (!index_) {
    if (indexRequest_ == 0) requestIndex(indexRejected_);
    return;
  }
  // What is at hand changes the wishes, and soon.
  if (readyWaits() && plansInRow_ > 0 && plansInRow_ < kMostPlansInRow) return;
  if (queueNext_ == queue_.size() && !aheadQueue_.empty() && to_.progress.visible == 0) {
    requestAhead();
    return;
  }
  const bool restGoesOn =
      to_.cache != nullptr && queueNext_ == queue_.size() && flights_.empty() && ready_.empty();
  if (to_.progress.completing && (!restPlanned_ || restGoesOn)) planRest();
  while (hasRoom() && !inTrouble() && queueNext_ < queue_.size() && mayAsk()) {
    const uint32_t chunk = queue_[queueNext_++];
    if (!held_.has(chunk) && underWay_[chunk] == 0) (void)send(chunk, false);
  }
}

void ChunkSource::requestAhead() {
  while (flights_.empty() && !aheadQueue_.empty()) {
    const uint32_t chunk = aheadQueue_.front();
    aheadQueue_.erase(aheadQueue_.begin());
    if (held_.has(chunk)) continue;
    if (!mayAsk()) return;
    send(chunk, false).ahead = true;
  }
}

ChunkSource::Flight& ChunkSource::send(uint32_t chunk, bool bypassCaches) {
  Flight& flight = flights_.emplace_back();
  flight.sequence = ++lastSequence_;
  flight.chunk = chunk;
  underWay_[chunk] = 1;
  ++to_.statistics.requests;
  FetchRequest request;
  request.url = to_.url.chunk(to_.revision, chunk);
  request.maxBodyBytes = kMaxChunkBytes;
  request.received = to_.received;
  request.bypassCaches = bypassCaches;
  const uint32_t key = resourceKey(to_.revision, "chunks/" + std::to_string(chunk));
  flight.id =
      to_.transport.send(std::move(request), chunkInto(to_.inbox, key, flight.sequence, tables_));
  return flight;
}

// --- answers -------------------------------------------------------------------------------------

void ChunkSource::take(Arrival arrival) {
  if (auto* index = std::get_if<ChunkIndexArrival>(&arrival)) takeIndex(std::move(*index));
  auto* chunk = std::get_if<ChunkArrival>(&arrival);
  if (chunk == nullptr) return;
  // Flights given up meanwhile are not found.
  for (Flight& flight : flights_) {
    if (flight.sequence != chunk->sequence) continue;
    flight.arrival = std::move(*chunk);
    return;
  }
}

bool ChunkSource::canApply() const {
  return readyWaits() || (!flights_.empty() && flights_.front().arrival);
}

bool ChunkSource::apply(size_t maxSplits) {
  if (!canApply()) return false;
  if (!readyWaits() && !takeFirstFlight()) return false;
  if (!applyReady(maxSplits) || inTrouble()) return false;
  to_.progress.ranked = false;
  if (to_.options.freshRanking && !to_.progress.completing) {
    queue_.clear();
    queueNext_ = 0;
  }
  return true;
}

bool ChunkSource::takeFirstFlight() {
  Flight flight = std::move(flights_.front());
  flights_.pop_front();
  underWay_[flight.chunk] = 0;
  to_.progress.ranked = false;
  FetchResponse& response = flight.arrival->response;
  if (response.status != 200) {
    restPlanned_ = false;
    reportRefusal(to_.url, response, "a request for a chunk");
    return false;
  }
  const Result<Chunk>& chunk = flight.arrival->chunk;
  const std::string fault = chunk ? faultOf(flight.chunk, *chunk) : chunk.error().message;
  if (!fault.empty()) {
    reject(flight.chunk, fault);
    return false;
  }
  ++to_.statistics.answers;
  budget_.observeAnswer(response.traffic.headerBytesDown, response.traffic.bodyBytesDown,
                        chunk->entries.size());
  to_.statistics.answersFromCaches += cameFromCache(response) ? 1 : 0;
  longestChunk_ = std::max<uint64_t>(longestChunk_, response.body.size());
  for (const RecordEntry& entry : chunk->entries)
    local_.keep(entry.id, response.body, entry.bitOffset, entry.bitLength);
  held_.hold(flight.chunk, std::move(response.body), chunk->entries);
  makeReady(flight.chunk);
  return true;
}

// A sound chunk may still be another one than was asked for. Empty: it is the right one.
std::string ChunkSource::faultOf(uint32_t number, const Chunk& chunk) const {
  if (chunk.band != bands_[number] || chunk.entries.empty() ||
      chunk.entries.front().id != firstNodes_[number])
    return "it is not the one that the index names";
  const bool lastOfBand = number + 1 == bands_.size() || bands_[number + 1] != bands_[number];
  if (!lastOfBand && !(chunk.entries.back().id < firstNodes_[number + 1]))
    return "it holds records of the next one";
  return {};
}

// What the arrived chunk was asked for.
void ChunkSource::makeReady(uint32_t chunk) {
  if (to_.progress.completing) {
    for (const HeldRecord& record : held_.recordsOf(chunk)) {
      const std::optional<NodeIndex> node = mesh_.find(record.id);
      if (!node || !mesh_.isActive(*node)) continue;
      ready_.add(
          {*node, mesh_.slot(*node), 0, static_cast<uint8_t>(mesh_.level(*node)), record.id});
    }
    return;
  }
  std::erase_if(waiting_, [&](const Place& place) {
    if (place.chunk != chunk) return false;
    ready_.add(place.candidate);
    return true;
  });
}

// True when nothing is left to apply.
bool ChunkSource::applyReady(size_t maxSplits) {
  while (readyWaits()) {
    if (maxSplits == 0) return false;
    if (budget_.recordsLeft(to_.statistics.records) == 0) {
      ready_.clear();
      return false;
    }
    const Candidate candidate = ready_.takeFirst();
    if (!mesh_.isActive(candidate.node) || mesh_.isLeaf(candidate.node)) continue;
    --maxSplits;
    const std::optional<uint32_t> chunk =
        index_ ? index_->find(candidate.id, mesh_.level(candidate.node)) : std::nullopt;
    if (split(candidate.node, chunk)) {
      to_.allowance.use();
      addChildren(candidate);
    } else if (chunk) {
      waiting_.push_back({candidate, *chunk});
    }
  }
  ready_.clear();
  return true;
}

// Children are split along with their parents: held ones all in one go, since they have been paid
// for; of others, and where frames must be short, as many as the counts tell to be seen.
void ChunkSource::addChildren(const Candidate& parent) {
  const NodeIndex left = mesh_.leftChild(parent.node);
  for (const NodeIndex node : {left, left + 1}) {
    if (mesh_.isLeaf(node) || !isAtHand(node)) continue;
    const Candidate child = childCandidate(mesh_, parent, node);
    const bool paidFor = to_.options.freshRanking && isHeld(node);
    if (paidFor || child.pixels > 0 || to_.progress.completing) ready_.add(child);
  }
}

// False: the record is not there, or no good.
bool ChunkSource::split(NodeIndex node, std::optional<uint32_t> chunk) {
  if (!isHeld(node)) return local_.split(node);  // else damaged, and to be asked for again
  const std::optional<HeldRecord> record = held_.find(*chunk, mesh_.id(node));
  if (!record) {
    reject(*chunk, "it lacks a record that the index places in it");
    return false;
  }
  const Result<void> done =
      mesh_.split(node, held_.bytesOf(*chunk), record->bitOffset, record->bitLength);
  if (!done) {
    reject(*chunk, done.error().message);
    return false;
  }
  ++to_.statistics.records;
  held_.countApplied(*chunk);
  return true;
}

// Asks for the chunk again, past every cache; the second damaged answer ends it.
void ChunkSource::reject(uint32_t chunk, const std::string& problem) {
  ++to_.statistics.malformed;
  held_.forget(chunk);
  if (rejected_[chunk] != 0) {
    report({SourceTrouble::Kind::damaged, "chunk " + std::to_string(chunk) +
                                              " is damaged, and so is its repetition: " + problem});
    return;
  }
  rejected_[chunk] = 1;
  (void)send(chunk, true);
}

// --- the end -------------------------------------------------------------------------------------

void ChunkSource::cancelAll() {
  if (indexRequest_ != 0) to_.transport.cancel(indexRequest_);
  for (const Flight& flight : flights_)
    if (!flight.arrival) to_.transport.cancel(flight.id);
}

void ChunkSource::giveUp() {
  cancelAll();
  indexRequest_ = 0;
  for (const Flight& flight : flights_) underWay_[flight.chunk] = 0;
  flights_.clear();
  std::fill(rejected_.begin(), rejected_.end(), uint8_t{0});
  indexRejected_ = false;
  aheadQueue_.clear();
  forgetPlans();
}

// Chunks that are used up are asked for again where they turn out to be needed: isAtHand().
void ChunkSource::forgot(std::span<const NodeId>) {
  forgetPlans();
  aheadQueue_.clear();
  to_.progress.ranked = false;
}

}  // namespace meshfront
