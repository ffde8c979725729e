#include "shared/receiver/chunk_source.h"

#include <algorithm>
#include <utility>

#include "shared/receiver/ranking.h"
#include "shared/store/entity_tag.h"

namespace meshfront {
namespace {

constexpr size_t kMaxChunkBytes = size_t{512} << 10;  // 512 records are about 2 KB
constexpr uint64_t kMaxIndexBytes = uint64_t{64} << 20;
constexpr uint64_t kIndexBytesPerChunk = 18;  // at most: a tree's number and a path
constexpr uint64_t kIndexBytesBeside = 1'024;
constexpr double kLongerThanMean = 1.25;
constexpr size_t kQueuedChunks = 32;  // ranked ahead, where rankings are used up

struct Wish {
  uint32_t chunk = 0;
  uint8_t band = 0;
  uint64_t pixels = 0;  // of the visible roots in it
};

// As ranksBefore() for nodes: a chunk's band is the level of its nodes.
bool ranksBefore(RankOrder order, const Wish& a, const Wish& b) {
  if (order == RankOrder::significance && a.band != b.band) return a.band < b.band;
  if (a.pixels != b.pixels) return a.pixels > b.pixels;
  return a.chunk < b.chunk;
}

}  // namespace

ChunkSource::ChunkSource(SourceSurroundings surroundings)
    : to_(std::move(surroundings)),
      mesh_(to_.mesh),
      tables_(std::make_shared<const CodeTables>(mesh_.base().tables)),
      budget_(to_.options.limits) {
  if (mesh_.splitCount() > 0) {
    // A full one; the coarse ones, which come first, have longer records than most.
    const double perRecord =
        static_cast<double>(to_.chunkBytes) / static_cast<double>(mesh_.splitCount());
    const double full = kLongerThanMean * kRecordsPerChunk * perRecord;
    longestChunk_ = static_cast<uint64_t>(
        std::min({full, static_cast<double>(to_.chunkBytes), static_cast<double>(kMaxChunkBytes)}));
  }
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
  index_ = std::move(*arrival.index);
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

// --- what to ask for -----------------------------------------------------------------------------

void ChunkSource::rank(std::span<const uint32_t> pixels) {
  if (!to_.progress.completing) forgetPlans();
  std::vector<Candidate> visible = visibleCandidates(mesh_, pixels, {});
  to_.progress.see(visible.size(), idle(), to_.options, to_.statistics);
  if (index_ && !to_.progress.completing) planView(visible);
}

void ChunkSource::planView(std::span<const Candidate> visible) {
  forgetPlans();
  std::vector<uint64_t> pixels(firstNodes_.size());
  std::vector<Wish> wishes;
  for (const Candidate& candidate : visible) {
    const std::optional<uint32_t> chunk = chunkOf(candidate.node);
    if (!chunk) return;
    if (held_.has(*chunk)) {
      ready_.push_back({candidate.node, *chunk});
      continue;
    }
    waiting_.push_back({candidate.node, *chunk});
    if (underWay_[*chunk] != 0) continue;
    if (pixels[*chunk] == 0) wishes.push_back({*chunk, bands_[*chunk], 0});
    pixels[*chunk] += candidate.pixels;
  }
  for (Wish& wish : wishes) wish.pixels = pixels[wish.chunk];
  const RankOrder order = to_.options.order;
  std::sort(wishes.begin(), wishes.end(),
            [order](const Wish& a, const Wish& b) { return ranksBefore(order, a, b); });
  if (!to_.options.freshRanking && wishes.size() > kQueuedChunks) wishes.resize(kQueuedChunks);
  for (const Wish& wish : wishes) queue_.push_back(wish.chunk);
}

// What no view asked for, in the order of the bands.
void ChunkSource::planRest() {
  forgetPlans();
  restPlanned_ = true;
  for (uint32_t chunk = 0; chunk < firstNodes_.size(); ++chunk)
    if (!held_.has(chunk) && underWay_[chunk] == 0) queue_.push_back(chunk);
  for (const Candidate& candidate : allCandidates(mesh_, {})) {
    const std::optional<uint32_t> chunk = chunkOf(candidate.node);
    if (!chunk) return;
    if (held_.has(*chunk)) ready_.push_back({candidate.node, *chunk});
  }
}

void ChunkSource::forgetPlans() {
  queue_.clear();
  queueNext_ = 0;
  waiting_.clear();
  ready_.clear();
  readyNext_ = 0;
  restPlanned_ = false;
}

bool ChunkSource::hasRoom() const {
  return flights_.size() < windowOf(to_.options);
}

bool ChunkSource::wantsRanking() const {
  return index_ && hasRoom() && !to_.progress.completing && !to_.progress.ranked &&
         readyNext_ == ready_.size() && queueNext_ == queue_.size();
}

// Limits let one more chunk in.
bool ChunkSource::mayAsk() const {
  uint64_t pending = 0;
  for (const Flight& flight : flights_) pending += flight.arrival ? 0 : 1;
  const ReceiverStatistics& statistics = to_.statistics;
  return budget_.recordsLeft(statistics.records) > 0 &&
         budget_.answerAllowed(statistics.traffic.bytesDown(), pending, longestChunk_);
}

bool ChunkSource::limitReached() const {
  if (budget_.recordsLeft(to_.statistics.records) == 0) return true;
  return queueNext_ < queue_.size() && !mayAsk();
}

bool ChunkSource::exhausted() const {
  return restPlanned_ && queueNext_ == queue_.size();
}

bool ChunkSource::idle() const {
  return flights_.empty() && readyNext_ == ready_.size() && indexRequest_ == 0;
}

void ChunkSource::request() {
  if (!index_) {
    if (indexRequest_ == 0) requestIndex(indexRejected_);
    return;
  }
  if (to_.progress.completing && !restPlanned_) planRest();
  while (hasRoom() && !inTrouble() && queueNext_ < queue_.size() && mayAsk()) {
    const uint32_t chunk = queue_[queueNext_++];
    if (!held_.has(chunk) && underWay_[chunk] == 0) send(chunk, false);
  }
}

void ChunkSource::send(uint32_t chunk, bool bypassCaches) {
  Flight& flight = flights_.emplace_back();
  flight.sequence = ++lastSequence_;
  flight.chunk = chunk;
  underWay_[chunk] = 1;
  ++to_.statistics.requests;
  FetchRequest request;
  request.url = to_.url.chunk(to_.revision, chunk);
  request.maxBodyBytes = kMaxChunkBytes;
  request.bypassCaches = bypassCaches;
  const uint32_t key = resourceKey(to_.revision, "chunks/" + std::to_string(chunk));
  flight.id =
      to_.transport.send(std::move(request), chunkInto(to_.inbox, key, flight.sequence, tables_));
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
  return readyNext_ < ready_.size() || (!flights_.empty() && flights_.front().arrival);
}

bool ChunkSource::apply(size_t maxSplits) {
  if (!canApply()) return false;
  if (readyNext_ == ready_.size() && !takeFirstFlight()) return false;
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
  longestChunk_ = std::max<uint64_t>(longestChunk_, response.body.size());
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
      if (node && mesh_.isActive(*node)) ready_.push_back({*node, chunk});
    }
    return;
  }
  const auto here = std::stable_partition(waiting_.begin(), waiting_.end(),
                                          [chunk](const Place& p) { return p.chunk != chunk; });
  ready_.insert(ready_.end(), here, waiting_.end());
  waiting_.erase(here, waiting_.end());
}

// True when nothing is left to apply.
bool ChunkSource::applyReady(size_t maxSplits) {
  while (readyNext_ < ready_.size()) {
    if (maxSplits == 0) return false;
    if (budget_.recordsLeft(to_.statistics.records) == 0) {
      ready_.clear();
      readyNext_ = 0;
      return false;
    }
    const Place place = ready_[readyNext_++];
    if (!mesh_.isActive(place.node) || mesh_.isLeaf(place.node)) continue;
    --maxSplits;
    if (!split(place)) {
      waiting_.push_back(place);
      continue;
    }
    for (const NodeIndex child : {mesh_.leftChild(place.node), mesh_.leftChild(place.node) + 1}) {
      if (mesh_.isLeaf(child)) continue;
      const std::optional<uint32_t> chunk = index_->find(mesh_.id(child), mesh_.level(child));
      if (chunk && held_.has(*chunk)) ready_.push_back({child, *chunk});
    }
  }
  ready_.clear();
  readyNext_ = 0;
  return true;
}

// False: the record is not there, or no good.
bool ChunkSource::split(const Place& place) {
  if (mesh_.hasRecord(place.node)) return mesh_.resplit(place.node).has_value();
  if (!held_.has(place.chunk)) return false;  // rejected meanwhile
  const std::optional<HeldRecord> record = held_.find(place.chunk, mesh_.id(place.node));
  if (!record) {
    reject(place.chunk, "it lacks a record that the index places in it");
    return false;
  }
  const Result<void> done =
      mesh_.split(place.node, held_.bytesOf(place.chunk), record->bitOffset, record->bitLength);
  if (!done) {
    reject(place.chunk, done.error().message);
    return false;
  }
  ++to_.statistics.records;
  held_.countApplied(place.chunk);
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
  send(chunk, true);
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
  forgetPlans();
}

}  // namespace meshfront
