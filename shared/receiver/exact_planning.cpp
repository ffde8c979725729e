// Which nodes a view, one that may come, or the rest needs, in which order, and with how many of
// their descendants.
#include <algorithm>
#include <chrono>

#include "shared/receiver/exact_source.h"
#include "shared/receiver/first_request.h"
#include "shared/receiver/ranking.h"

namespace meshfront {
namespace {

constexpr size_t kCompletingBatches = 8;  // queued at a time
// Both from tests/bench/receiver_latency: more octets for what is not seen are not worth the time.
constexpr uint32_t kMostLevelsByNeed = 2;  // generations
constexpr double kProbingProducts = 4;     // what the link may hold beyond what it was seen to

// Of the first requests, before answers have told what the link carries: what most links do, and
// what TCP sends before it waits for acknowledgements (RFC 6928).
constexpr double kLikelyBytesPerSecond = 250'000;
constexpr double kFirstFlightBytes = 10 * 1'448;
constexpr double kLikelyRecordBytes = 5.5;  // no answer has told yet
constexpr std::chrono::milliseconds kTripWorthGuessing{10};
constexpr double kShownByFiner = 0.9;  // of what is seen: then the others may come a trip later

}  // namespace

// How many records the first answer may hold. On a long link more cost no time and spare further
// round trips; what of them turns out not to be seen is some of kFirstFlightBytes.
double ExactSource::firstRoom() const {
  if (!tripWorthGuessing()) return kFirstRecords;
  const std::chrono::duration<double> trip = *to_.link.roundTrip();
  const double bytes = std::min(kLikelyBytesPerSecond * trip.count(), kFirstFlightBytes);
  return std::max(kFirstRecords, bytes / kLikelyRecordBytes);
}

// Takes out of `chosen` what is better left to the second request.
std::optional<uint8_t> ExactSource::significanceAtFirst(std::vector<Wish>& chosen) const {
  if (!to_.options.descendants || mesh_.splitsApplied() > 0 || to_.allowance.limited())
    return std::nullopt;
  const auto count = static_cast<double>(chosen.size());
  const double share = count / std::max(count, static_cast<double>(wished_));
  const double room = (firstRoom() - static_cast<double>(pendingRecords())) * share;
  uint64_t pixels = 0;
  std::vector<uint8_t> levels;
  for (const Wish& wish : chosen) {
    pixels += wish.pixels;
    levels.push_back(static_cast<uint8_t>(mesh_.level(wish.node)));
  }
  const auto forAll = firstSignificance(levels, pixels, room, tables_->maxLevel);
  if (!forAll || !tripWorthGuessing()) return forAll;
  const size_t finer = nodesOneLevelFiner(levels, *forAll, room, tables_->maxLevel);
  uint64_t shown = 0;
  for (size_t i = 0; i < finer; ++i) shown += chosen[i].pixels;
  if (static_cast<double>(shown) < kShownByFiner * static_cast<double>(pixels)) return forAll;
  chosen.resize(finer);
  return static_cast<uint8_t>(*forAll + 1);
}

uint64_t ExactSource::likelyRecords(const RecordRequest& request) const {
  const Expansion& expansion = request.expansion;
  if (!expansion.significance)
    return request.nodes.size() * ((uint64_t{2} << expansion.levels) - 1);
  double records = 0;
  for (const uint8_t level : request.levels) records += recordsUpTo(*expansion.significance, level);
  return static_cast<uint64_t>(std::min(records, static_cast<double>(mesh_.splitCount())));
}

bool ExactSource::tripWorthGuessing() const {
  const auto trip = to_.link.roundTrip();
  return !to_.options.freshRanking && trip && *trip >= kTripWorthGuessing;
}

// Generations to ask for in one go. Where all that is wished for does not fill the link for a round
// trip, the next generation costs no time, and some octets for what turns out not to be seen. No
// more than the pixels tell: a node that shows eight cannot need more than three.
uint32_t ExactSource::levelsByNeed(const std::vector<Wish>& chosen) const {
  if (!tripWorthGuessing() || !to_.options.descendants || chosen.empty()) return 0;
  uint64_t pixels = 0;
  for (const Wish& wish : chosen) pixels += wish.pixels;
  const auto count = static_cast<double>(chosen.size());
  const double wished = std::max(count, static_cast<double>(wished_));
  const double room = kProbingProducts * to_.link.productBytes() / budget_.bytesPerRecord() -
                      static_cast<double>(pendingRecords());
  const uint64_t allowed = to_.allowance.leftBeside(pendingRecords());
  uint32_t levels = 0;
  while (levels < kMostLevelsByNeed) {
    const auto generations = static_cast<double>((uint64_t{4} << levels) - 1);
    if (wished * generations > room || count * generations > static_cast<double>(allowed)) break;
    if (count * static_cast<double>(uint64_t{2} << levels) > static_cast<double>(pixels)) break;
    ++levels;
  }
  return levels;
}

// What no view asked for, coarse levels first. Descendants that share the level come along
// (Expansion), which saves the round trip for each generation.
void ExactSource::refillFromRest() {
  forgetQueue();
  // Descendants arrive with a request for their ancestors: one level after the other.
  if (!flights_.empty()) return;
  std::vector<Candidate> rest = allCandidates(mesh_, busy_);
  restExhausted_ = rest.empty();
  if (rest.empty()) return;
  planOrQueue(rest, kCompletingBatches * kCompletingBatch);
  if (queue_.empty()) return;
  const size_t decisive = std::min(queue_.size(), kCompletingBatch / 2) - 1;
  queueExpansion_ = static_cast<uint8_t>(mesh_.level(queue_[decisive].node));
  std::erase_if(queue_, [this](const Wish& w) { return mesh_.level(w.node) > *queueExpansion_; });
}

// Sorts the first `queued` of what is not at hand into the queue.
void ExactSource::planOrQueue(std::vector<Candidate>& candidates, size_t queued) {
  plan_.clear();
  std::erase_if(candidates, [this](const Candidate& candidate) {
    if (!local_.has(candidate.node)) return false;
    plan_.add(candidate);
    return true;
  });
  wished_ = candidates.size();
  const RankOrder order = to_.progress.completing ? RankOrder::significance : to_.options.order;
  keepFirst(candidates, queued, order);
  for (const Candidate& candidate : candidates)
    queue_.push_back({candidate.node, candidate.pixels});
}

void ExactSource::rank(std::span<const uint32_t> pixels, const RankingBias& bias) {
  markUnapplied();
  claimAhead(pixels);
  std::vector<Candidate> visible = visibleCandidates(mesh_, pixels, busy_, bias);
  if (!visible.empty() && dropStale(pixels))
    visible = visibleCandidates(mesh_, pixels, busy_, bias);
  to_.progress.see(visible.size(), idle(), to_.options, to_.statistics);
  if (to_.progress.completing) return;
  forgetQueue();
  // Without fresh rankings the queue fills the window twice: at once, and until the next ranking.
  const size_t ahead = to_.options.freshRanking ? windowNow(to_) : 2 * size_t{windowNow(to_)};
  planOrQueue(visible, std::min(ahead * std::max<size_t>(batchSize(), 1), bias.atMost));
  plansInRow_ = plan_.empty() ? 0 : plansInRow_ + 1;
}

void ExactSource::rankAhead(std::span<const uint32_t> pixels) {
  aheadQueue_.clear();
  std::vector<Candidate> expected = visibleCandidates(mesh_, pixels, busy_);
  std::erase_if(expected, [this](const Candidate& c) { return local_.has(c.node); });
  keepFirst(expected, std::max<size_t>(batchSize(), 1), to_.options.order);
  for (const Candidate& candidate : expected)
    aheadQueue_.push_back({candidate.node, candidate.pixels});
}

void ExactSource::forgetQueue() {
  queue_.clear();
  queueNext_ = 0;
  wished_ = 0;
  queueExpansion_.reset();
}

bool ExactSource::wantsRanking() const {
  if (to_.progress.completing || to_.progress.ranked || planWaits()) return false;
  return plansInRow_ > 0 || (hasRoom() && queueNext_ == queue_.size());
}

// What was asked for ahead and is seen now belongs to the view.
void ExactSource::claimAhead(std::span<const uint32_t> pixels) {
  for (const auto& flight : flights_)
    if (flight->ahead && seenNodes(*flight, pixels) > 0) flight->ahead = false;
}

// The view has moved on: gives up what it shows little of while something better waits.
bool ExactSource::dropStale(std::span<const uint32_t> pixels) {
  bool dropped = false;
  for (auto flight = flights_.begin(); flight != flights_.end();) {
    const auto at = flight - flights_.begin();
    const bool stale =
        !to_.options.freshRanking && 2 * seenNodes(**flight, pixels) < (*flight)->nodes.size();
    if ((*flight)->arrival || !(stale || (*flight)->ahead)) {
      ++flight;
      continue;
    }
    to_.transport.cancel((*flight)->id);
    ++to_.statistics.cancelled;
    dropFlight(flight);
    flight = flights_.begin() + at;
    dropped = true;
  }
  aheadQueue_.clear();
  return dropped;
}

size_t ExactSource::seenNodes(const Flight& flight, std::span<const uint32_t> pixels) const {
  return static_cast<size_t>(
      std::count_if(flight.nodes.begin(), flight.nodes.end(), [&](NodeIndex node) {
        if (!mesh_.isActive(node)) return false;
        const VertexSlot slot = mesh_.slot(node);
        return slot < pixels.size() && pixels[slot] > 0;
      }));
}

}  // namespace meshfront
