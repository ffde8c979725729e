// Which chunks a view, one that may come, or the rest needs, and in which order.
#include <algorithm>

#include "shared/receiver/chunk_source.h"
#include "shared/receiver/ranking.h"

namespace meshfront {
namespace {

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

// --- what to ask for -----------------------------------------------------------------------------

void ChunkSource::rank(std::span<const uint32_t> pixels, const RankingBias& bias) {
  if (!to_.progress.completing) forgetPlans();
  const std::vector<Candidate> visible = visibleCandidates(mesh_, pixels, {}, bias);
  if (index_ && !visible.empty()) dropStale(visible);
  to_.progress.see(visible.size(), idle(), to_.options, to_.statistics);
  if (!to_.progress.completing) planView(visible, bias.atMost);
}

void ChunkSource::planView(std::span<const Candidate> visible, size_t atMost) {
  forgetPlans();
  std::vector<Candidate> wanted;
  bool anyAtHand = false;
  for (const Candidate& candidate : visible) {
    if (isAtHand(candidate.node)) {
      ready_.add(candidate);
      anyAtHand = anyAtHand || !isHeld(candidate.node);
    } else {
      wanted.push_back(candidate);
    }
  }
  plansInRow_ = anyAtHand ? plansInRow_ + 1 : 0;
  if (wanted.size() > atMost) keepFirst(wanted, atMost, to_.options.order);
  if (!index_ || !rankChunks(wanted, queue_, &waiting_)) return;
  // Without fresh rankings the queue fills the window twice: at once, and until the next ranking.
  const size_t ahead = 2 * size_t{windowNow(to_)};
  if (!to_.options.freshRanking && queue_.size() > ahead) queue_.resize(ahead);
}

bool ChunkSource::rankChunks(std::span<const Candidate> candidates, std::vector<uint32_t>& chunks,
                             std::vector<Place>* places) {
  std::vector<uint64_t> pixels(firstNodes_.size());
  std::vector<uint8_t> met(firstNodes_.size());
  std::vector<Wish> wishes;
  for (const Candidate& candidate : candidates) {
    const std::optional<uint32_t> chunk = chunkOf(candidate.node);
    if (!chunk) return false;
    if (places != nullptr) places->push_back({candidate, *chunk});
    if (underWay_[*chunk] != 0) continue;
    if (met[*chunk] == 0) wishes.push_back({*chunk, bands_[*chunk], 0});
    met[*chunk] = 1;
    pixels[*chunk] += candidate.pixels;
  }
  for (Wish& wish : wishes) wish.pixels = pixels[wish.chunk];
  const RankOrder order = to_.options.order;
  std::sort(wishes.begin(), wishes.end(),
            [order](const Wish& a, const Wish& b) { return ranksBefore(order, a, b); });
  for (const Wish& wish : wishes) chunks.push_back(wish.chunk);
  return true;
}

void ChunkSource::rankAhead(std::span<const uint32_t> pixels) {
  aheadQueue_.clear();
  if (!index_) return;
  std::vector<Candidate> expected = visibleCandidates(mesh_, pixels, {});
  std::erase_if(expected, [this](const Candidate& c) { return isAtHand(c.node); });
  (void)rankChunks(expected, aheadQueue_, nullptr);
}

// What no view asked for, in the order of the bands. Where there is a disk cache the records of a
// chunk may be there that has never been held: then only those are asked for that the front needs,
// again and again.
void ChunkSource::planRest() {
  forgetPlans();
  restPlanned_ = true;
  std::vector<Candidate> missing;
  for (const Candidate& candidate : allCandidates(mesh_, {})) {
    if (isAtHand(candidate.node)) {
      ready_.add(candidate);
    } else if (!chunkOf(candidate.node)) {
      return;
    } else {
      missing.push_back(candidate);
    }
  }
  if (to_.cache != nullptr) {
    (void)rankChunks(missing, queue_, nullptr);
    return;
  }
  for (uint32_t chunk = 0; chunk < firstNodes_.size(); ++chunk)
    if (!held_.has(chunk) && underWay_[chunk] == 0) queue_.push_back(chunk);
}

void ChunkSource::forgetPlans() {
  queue_.clear();
  queueNext_ = 0;
  waiting_.clear();
  ready_.clear();
  restPlanned_ = false;
}

bool ChunkSource::isAtHand(NodeIndex node) {
  return isHeld(node) || local_.has(node);
}

bool ChunkSource::isHeld(NodeIndex node) {
  if (!index_ || mesh_.hasRecord(node)) return false;
  const std::optional<uint32_t> chunk = index_->find(mesh_.id(node), mesh_.level(node));
  if (!chunk || !held_.has(*chunk)) return false;
  if (!held_.isUsedUp(*chunk)) return true;
  held_.forget(*chunk);  // the mesh has forgotten what was in it
  return false;
}

// The view has moved on: gives up what nothing visible needs while something else waits. What was
// asked for ahead and is seen now belongs to the view.
void ChunkSource::dropStale(std::span<const Candidate> visible) {
  aheadQueue_.clear();
  if (flights_.empty()) return;
  std::vector<uint8_t> wanted(firstNodes_.size());
  bool someWait = false;
  for (const Candidate& candidate : visible) {
    const std::optional<uint32_t> chunk = index_->find(candidate.id, mesh_.level(candidate.node));
    if (!chunk || isAtHand(candidate.node)) continue;
    wanted[*chunk] = 1;
    someWait = someWait || underWay_[*chunk] == 0;
  }
  if (!someWait) return;
  for (Flight& flight : flights_) flight.ahead = flight.ahead && wanted[flight.chunk] == 0;
  std::erase_if(flights_, [&](const Flight& flight) {
    const bool stale = !to_.options.freshRanking && wanted[flight.chunk] == 0;
    if (flight.arrival || !(stale || flight.ahead)) return false;
    to_.transport.cancel(flight.id);
    ++to_.statistics.cancelled;
    underWay_[flight.chunk] = 0;
    return true;
  });
}

}  // namespace meshfront
