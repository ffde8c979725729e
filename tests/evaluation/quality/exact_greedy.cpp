#include "tests/evaluation/quality/exact_greedy.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

namespace meshfront::evaluation {
namespace {

uint64_t squaredDifference(const Picture& a, const Picture& b) {
  uint64_t squares = 0;
  for (size_t i = 0; i < a.rgb.size(); ++i) {
    const int difference = int{a.rgb[i]} - int{b.rgb[i]};
    squares += static_cast<uint64_t>(difference * difference);
  }
  return squares;
}

double psnrOfSquares(uint64_t squares, size_t samples) {
  if (squares == 0) return kIdenticalPicturesPsnr;
  const double mean = static_cast<double>(squares) / static_cast<double>(samples);
  return std::min(10 * std::log10(255.0 * 255.0 / mean), kIdenticalPicturesPsnr);
}

class GreedySearch {
 public:
  GreedySearch(RefinedPack refined, std::span<const uint8_t> allowed, Easel& easel,
               const EvaluationView& view, const Picture& reference, bool lookAhead)
      : refined_(std::move(refined)),
        allowed_(allowed),
        reference_(reference),
        lookAhead_(lookAhead),
        canvas_(easel, refined_.mesh(), refined_.pack().metadata().quantization, view),
        states_(refined_.pack().records().size()) {}

  Result<GreedyOrder> run(double stopAt) {
    if (Result<void> drawn = drawCurrent(); !drawn) return tl::unexpected(drawn.error());
    note();
    for (NodeIndex root = 0; root < refined_.pack().base().treeCount(); ++root)
      if (Result<void> done = evaluate(refined_.recordOf(root)); !done)
        return tl::unexpected(done.error());
    while (!best_.empty() && found_.curve.back().psnr < stopAt) {
      const Entry top = best_.top();
      best_.pop();
      State& state = states_[top.record];
      if (state.stamp != top.stamp) continue;  // tried again since
      if (state.stale) {
        if (Result<void> done = evaluate(top.record); !done) return tl::unexpected(done.error());
        continue;
      }
      if (Result<void> done = take(top.record); !done) return tl::unexpected(done.error());
    }
    return std::move(found_);
  }

 private:
  struct State {
    uint32_t stamp = 0;
    bool stale = false;
  };
  struct Entry {
    double gain = 0;
    RecordIndex record = kNoRecord;
    uint32_t stamp = 0;
    bool operator<(const Entry& other) const {
      return gain != other.gain ? gain < other.gain : record > other.record;
    }
  };

  [[nodiscard]] bool canSplit(RecordIndex record) const {
    if (record == kNoRecord || allowed_[record] == 0) return false;
    const NodeIndex node = refined_.nodeOf(record);
    return node != kNone && refined_.mesh().isActive(node);
  }

  Result<uint64_t> squaresNow() {
    const Result<Picture> picture = canvas_.draw();
    if (!picture) return tl::unexpected(picture.error());
    ++found_.pictures;
    return squaredDifference(*picture, reference_);
  }
  Result<void> drawCurrent() {
    const Result<uint64_t> squares = squaresNow();
    if (!squares) return tl::unexpected(squares.error());
    squares_ = *squares;
    return {};
  }
  void note() {
    found_.curve.push_back({1 + found_.order.size(), 0, found_.order.size(),
                            psnrOfSquares(squares_, reference_.rgb.size())});
  }

  // Tries a split and takes it back.
  Result<void> evaluate(RecordIndex record) {
    if (!canSplit(record)) return {};
    const NodeIndex node = refined_.nodeOf(record);
    if (Result<void> done = refined_.split(record); !done) return done;
    const Result<uint64_t> alone = squaresNow();
    if (!alone) return tl::unexpected(alone.error());
    double gain = static_cast<double>(squares_) - static_cast<double>(*alone);
    if (lookAhead_) {
      std::vector<RecordIndex> below;
      for (const RecordIndex child : refined_.pack().records()[record].children)
        if (canSplit(child)) below.push_back(child);
      for (const RecordIndex child : below)
        if (Result<void> done = refined_.split(child); !done) return done;
      if (!below.empty()) {
        const Result<uint64_t> together = squaresNow();
        if (!together) return tl::unexpected(together.error());
        gain = std::max(gain, (static_cast<double>(squares_) - static_cast<double>(*together)) /
                                  static_cast<double>(1 + below.size()));
      }
      while (!below.empty()) {
        refined_.mesh().collapse(refined_.nodeOf(below.back()));
        below.pop_back();
      }
    }
    refined_.mesh().collapse(node);
    State& state = states_[record];
    state.stale = false;
    best_.push({gain, record, ++state.stamp});
    return {};
  }

  Result<void> take(RecordIndex record) {
    const NodeIndex node = refined_.nodeOf(record);
    if (Result<void> done = refined_.split(record); !done) return done;
    found_.order.push_back(record);
    if (Result<void> drawn = drawCurrent(); !drawn) return drawn;
    note();
    ++states_[record].stamp;
    const NodeIndex left = refined_.mesh().leftChild(node);
    std::vector<RecordIndex> nearby;
    for (const NodeIndex child : {left, left + 1}) {
      addUnlessThere(nearby, refined_.recordOf(child));
      forEachNeighbour(refined_.mesh().slot(child), [&](VertexSlot slot) {
        addUnlessThere(nearby, recordAt(slot));
        forEachNeighbour(slot, [&](VertexSlot further) {
          const RecordIndex other = recordAt(further);
          if (other != kNoRecord) states_[other].stale = true;
        });
      });
    }
    for (const RecordIndex one : nearby)
      if (Result<void> done = evaluate(one); !done) return done;
    return {};
  }

  template <typename Visit>
  void forEachNeighbour(VertexSlot slot, const Visit& visit) const {
    const HalfEdgeMesh& edges = refined_.mesh().edges();
    edges.forEachOutgoing(slot, [&](HalfEdge h) { visit(edges.destination(h)); });
  }
  [[nodiscard]] RecordIndex recordAt(VertexSlot slot) const {
    return refined_.recordOf(refined_.mesh().nodeAt(slot));
  }
  static void addUnlessThere(std::vector<RecordIndex>& records, RecordIndex record) {
    if (record != kNoRecord && std::find(records.begin(), records.end(), record) == records.end())
      records.push_back(record);
  }

  RefinedPack refined_;
  const std::span<const uint8_t> allowed_;
  const Picture& reference_;
  const bool lookAhead_;
  Canvas canvas_;
  std::vector<State> states_;
  std::priority_queue<Entry> best_;
  uint64_t squares_ = 0;
  GreedyOrder found_;
};

}  // namespace

Result<GreedyOrder> exactGreedyOrder(const PackRecords& pack, std::span<const uint8_t> allowed,
                                     Easel& easel, const EvaluationView& view,
                                     const Picture& reference, double stopAt, bool lookAhead) {
  Result<RefinedPack> refined = RefinedPack::fromBase(pack);
  if (!refined) return tl::unexpected(refined.error());
  GreedySearch search(std::move(*refined), allowed, easel, view, reference, lookAhead);
  return search.run(stopAt);
}

}  // namespace meshfront::evaluation
