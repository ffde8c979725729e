#include "tests/evaluation/sender_driven/sender_session.h"

#include <algorithm>
#include <bit>
#include <ctime>
#include <limits>

#include "shared/bits/integer_codes.h"
#include "shared/refinement/slot_set.h"

namespace meshfront::evaluation {
namespace {

// Nodes that are taken, marked and tested together: few enough that the best ones come first, many
// enough that a part's loop is worth its start.
constexpr size_t kRound = 256;
// Below a node with fewer nodes, a test costs more than it saves.
constexpr uint32_t kWorthCulling = 12;

// Eighths of an octave, the largest first; 512 buckets.
uint32_t errorBucket(float size) {
  const auto bits = std::bit_cast<uint32_t>(size);
  const uint32_t eighths = bits >> 20;  // exponent and three bits, 0 .. 2047
  constexpr uint32_t kLeast = (127 - 24) << 3;
  constexpr uint32_t kMost = kLeast + 511;
  return kMost - std::clamp(eighths, kLeast, kMost);
}

// Sorts distinct numbers below `limit`, in a few instructions each.
void sortNodes(std::vector<uint32_t>& nodes, uint32_t limit) {
  thread_local SlotSet set;
  set.resize(limit);
  for (const uint32_t node : nodes) set.add(node);
  nodes.clear();
  set.forEach([&](uint32_t node) { nodes.push_back(node); });
  set.clear();
}

}  // namespace

// Gives the processor's time since its last call to a part.
class SenderSession::Clock {
 public:
  explicit Clock(const SenderTimes* times) : runs_(times != nullptr) {
    if (runs_) last_ = now();
  }
  void give(double SenderTimes::*part, SenderTimes* times) {
    if (!runs_) return;
    const double time = now();
    times->*part += time - last_;
    last_ = time;
  }

 private:
  static double now() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  bool runs_;
  double last_ = 0;
};

SenderSession::SenderSession(const SenderModel& model, const SenderOptions& options)
    : model_(model),
      options_(options),
      sent_(model.levelTags()),
      ids_(model,
           options.bookkeeping == Bookkeeping::vertexFront && options.ids == IdCoding::adaptive
               ? IdCoding::bitstring
               : options.ids) {
  if (!usesTags()) front_.assign(model.roots().begin(), model.roots().end());
  if (options_.ids == IdCoding::adaptive && !usesTags()) options_.ids = IdCoding::bitstring;
}

void SenderSession::look(const ViewRequest& request) {
  Clock clock(times_);
  view_ = ViewTest(request);
  everything_ = request.everything;
  onRest_ = false;
  queue_.drain([&](uint32_t node) {
    if (!usesTags()) front_.push_back(node);
  });
  findCandidates();
  clock.give(&SenderTimes::visibility, times_);
}

void SenderSession::findCandidates() {
  if (usesTags()) {
    scanTags();
  } else {
    scanFront();
  }
}

uint32_t SenderSession::bucketOf(uint32_t node, float size) const {
  const uint32_t bucket = errorBucket(size);
  // Half octaves within a level.
  return options_.order == SenderOrder::error ? bucket : model_.level(node) * 128 + bucket / 4;
}

void SenderSession::addIfAskedFor(uint32_t node) {
  float pixels = model_.criteria(node).error;
  if (onRest_ || view_.passes(model_.criteria(node), pixels)) {
    queue_.add(node, bucketOf(node, pixels));
  } else if (!usesTags()) {
    front_.push_back(node);
  }
}

void SenderSession::scanTags() {
  const uint32_t count = model_.nodeCount();
  for (uint32_t node = 0; node < count;) {
    const ViewCriteria& criteria = model_.criteria(node);
    if (!sent_.has(model_.level(node), model_.tag(node))) {
      addIfAskedFor(node);
      node = criteria.end;
      continue;
    }
    // Nothing below asks for anything either if the node does not.
    float pixels = 0;
    const bool culled =
        !onRest_ && criteria.end - node > kWorthCulling && !view_.passes(criteria, pixels);
    node = culled ? criteria.end : node + 1;
  }
}

void SenderSession::scanFront() {
  size_t kept = 0;
  for (const uint32_t node : front_) {
    float pixels = model_.criteria(node).error;
    if (onRest_ || view_.passes(model_.criteria(node), pixels)) {
      queue_.add(node, bucketOf(node, pixels));
    } else {
      front_[kept++] = node;
    }
  }
  front_.resize(kept);
}

void SenderSession::startOnRest() {
  onRest_ = true;
  queue_.drain([](uint32_t) {});
  findCandidates();
}

const SentBatch& SenderSession::next(size_t maxRecords) {
  Clock clock(times_);
  taken_.clear();
  if (options_.retest && !onRest_) {
    queue_.drain([&](uint32_t node) {
      if (!usesTags()) front_.push_back(node);
    });
    findCandidates();
    clock.give(&SenderTimes::visibility, times_);
  }
  while (taken_.size() < maxRecords) {
    if (queue_.empty()) {
      if (onRest_ || !everything_) break;
      startOnRest();
      clock.give(&SenderTimes::visibility, times_);
      if (queue_.empty()) break;
    }
    takeRound(maxRecords - taken_.size(), clock);
  }
  sentCount_ += taken_.size();
  writeMessage(clock);
  if (queue_.empty() && taken_.empty()) queue_.release();
  return batch_;
}

void SenderSession::takeRound(size_t most, Clock& clock) {
  const size_t before = taken_.size();
  queue_.take(std::min(most, kRound), taken_);
  clock.give(&SenderTimes::findSplits, times_);
  born_.clear();
  for (size_t i = before; i < taken_.size(); ++i) {
    const uint32_t node = taken_[i];
    if (usesTags()) sent_.set(model_.level(node), model_.tag(node));
    const uint32_t left = model_.leftChild(node);
    const uint32_t right = model_.rightChild(node);
    if (left != kNoNode) born_.push_back(left);
    if (right != kNoNode) born_.push_back(right);
  }
  clock.give(&SenderTimes::frontUpdate, times_);
  for (const uint32_t node : born_) addIfAskedFor(node);
  clock.give(&SenderTimes::visibility, times_);
}

void SenderSession::writeMessage(Clock& clock) {
  batch_.splits.clear();
  batch_.message.clear();
  batch_.idBits = batch_.recordBits = batch_.criterionBits = 0;
  if (taken_.empty()) return;
  if (options_.ids != IdCoding::published) sortNodes(taken_, model_.nodeCount());
  const auto ids = ids_.write(taken_, usesTags() ? &sent_ : nullptr, chances_);
  BitWriter out;
  out.reserve(16 + ids.size() + taken_.size() * 6);
  out.write(static_cast<unsigned>(options_.ids), 2);
  out.writeBit(options_.criteria);
  writeExpGolomb(out, taken_.size(), kMessageCountOrder);
  writeExpGolomb(out, ids.size(), kMessageCountOrder);
  out.write(0, static_cast<unsigned>(-out.bitCount() & 7));
  if (!ids.empty()) out.append(ids, 0, 8 * ids.size());
  batch_.idBits = out.bitCount();
  clock.give(&SenderTimes::encodeIds, times_);
  writeRecords(out);
  batch_.message = out.take();
  clock.give(&SenderTimes::findSplits, times_);
}

void SenderSession::writeRecords(BitWriter& out) {
  const auto idBits = static_cast<uint32_t>(batch_.idBits / taken_.size());
  auto further = static_cast<uint32_t>(batch_.idBits % taken_.size());
  for (const uint32_t node : taken_) {
    SentSplit split{node, idBits, model_.recordBits(node), 0};
    if (further > 0) {
      ++split.idBits;
      --further;
    }
    if (options_.ids == IdCoding::published) split.idBits = IdWriter::publishedBits(model_, node);
    out.append(model_.recordBytes(), model_.recordBegin(node), split.recordBits);
    batch_.recordBits += split.recordBits;
    if (options_.criteria) {
      const uint64_t begin = out.bitCount();
      const uint32_t parent = model_.parent(node);
      NodeCriterion::of(model_.criteria(node))
          .write(out,
                 parent == kNoNode ? NodeCriterion() : NodeCriterion::of(model_.criteria(parent)));
      split.criterionBits = static_cast<uint32_t>(out.bitCount() - begin);
      batch_.criterionBits += split.criterionBits;
    }
    batch_.splits.push_back(split);
  }
}

std::vector<SentSplit> SenderSession::answer(const ViewRequest& request, size_t batch) {
  std::vector<SentSplit> splits;
  look(request);
  for (;;) {
    const SentBatch& sent = next(batch);
    if (sent.splits.empty()) return splits;
    splits.insert(splits.end(), sent.splits.begin(), sent.splits.end());
  }
}

Result<void> SenderSession::resume(std::span<const uint8_t> leafList) {
  sent_.clear();
  front_.clear();
  queue_.drain([](uint32_t) {});
  sentCount_ = 0;
  chances_ = {};
  // A code of likely bits takes at least a thousandth of a bit each: more octets are no list.
  if (leafList.size() > size_t{model_.nodeCount()} + 16) {
    if (!usesTags()) front_.assign(model_.roots().begin(), model_.roots().end());
    return fail("the list of leaves is longer than that of the full mesh");
  }
  AdaptiveBitReader in(leafList);
  IdChances chances;
  for (uint32_t node = 0; node < model_.nodeCount();) {
    const unsigned level = model_.level(node);
    const bool isSplit =
        in.read(chances.of(IdChances::Child::split, IdChances::Sibling::none, level));
    if (isSplit) {
      ++sentCount_;
      if (usesTags()) sent_.set(level, model_.tag(node));
    } else if (!usesTags()) {
      front_.push_back(node);
    }
    node = isSplit ? node + 1 : model_.end(node);
  }
  return {};
}

size_t SenderSession::sessionBytes() const {
  const size_t learned = options_.ids == IdCoding::adaptive ? chances_.memoryBytes() : 0;
  return learned + (usesTags() ? sent_.memoryBytes() : front_.capacity() * sizeof(uint32_t));
}

}  // namespace meshfront::evaluation
