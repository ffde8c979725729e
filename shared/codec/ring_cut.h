// The cut code: where in the ring of a vertex its fan of faces is cut when it splits (after Kim and
// Lee 2001, coded so that any receiver reads just the prefix it needs).
//
// The *ring* of s is the cyclic, counter-clockwise list of its neighbours, one *entry* per edge at
// s, and the faces between them, its *gaps*: gap i lies between entries i and i + 1. A receiver's
// ring is the ring of the full mesh (the *static ring*, whose entries are leaves) with runs of
// entries under one active node merged. Both sides therefore walk from whole runs down to single
// entries:
//
// 1. Two neighbouring entries part at the depth of their lowest common ancestor (before depth 0 if
//    in different trees). The gaps that part earliest cut the ring into R >= 2 cyclic runs,
//    numbered from the one behind the smallest such gap in the total order of faces (FaceKey).
// 2. One symbol given R: the runs of l and of r; where they are the same one, also which comes
//    first.
// 3. While l and r share a run of several entries: the gaps in it that part earliest cut it into R
//    sub-runs; one symbol given R and the order: the sub-runs of l and of r.
// 4. Then l alone: while its run has several entries, is it the first of the sub-runs, the next
//    one, ..., from t's side on? Read forward. The same for r, read backward from the region's end.
//
// All choices are binary decisions; each has a context (cut_contexts.h) that tells from the places
// of the runs' nodes (cut_frame.h) what is likely. Encoder and decoder are one template.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "shared/codec/cut_contexts.h"
#include "shared/codec/cut_frame.h"
#include "shared/hierarchy/node_id.h"

namespace meshfront {

// The total order of faces: base faces by index, then by the node that created the face, f_l first.
struct FaceKey {
  uint64_t tree = 0;       // 0 for a base face, else the creator's tree + 1
  uint64_t path = 0;       // the creator's path; the index of a base face
  uint32_t depthSide = 0;  // the creator's depth * 2 + (0 for f_l, 1 for f_r)

  [[nodiscard]] static FaceKey ofBase(uint32_t index) { return {0, index, 0}; }
  [[nodiscard]] static FaceKey of(const NodeId& creator, bool isRight) {
    return {uint64_t{creator.tree} + 1, creator.path,
            uint32_t{creator.depth} * 2 + (isRight ? 1U : 0U)};
  }
  friend bool operator<(const FaceKey& a, const FaceKey& b) {
    return std::tie(a.tree, a.path, a.depthSide) < std::tie(b.tree, b.path, b.depthSide);
  }
};

struct RingCut {
  uint32_t left = 0;      // entry of the edge to l
  uint32_t right = 0;     // entry of the edge to r
  bool leftFirst = true;  // where both are the same edge: does l come before r in it?
};

// The depth at which two entries part: -1 for different trees.
[[nodiscard]] inline int partingDepth(const NodeId& a, const NodeId& b) {
  if (a.tree != b.tree) return -1;
  return std::countl_zero(a.path ^ b.path);
}

// Working space of the walk, kept between calls so that it allocates nothing.
struct RingWalkSpace {
  std::vector<int> parting;      // [i]: between entries i and i + 1, twice round
  std::vector<uint32_t> starts;  // of runs
};

// One of `count` symbols as decisions, the high bit first; bits that `count` settles are not coded.
// Node 1 .. of the decision tree have the contexts `first` + 1 ...
template <typename Coder>
uint32_t codeSymbol(Coder& coder, unsigned first, uint32_t count, uint32_t chosen) {
  uint32_t symbol = 0;
  uint32_t node = 1;
  for (auto i = static_cast<unsigned>(std::bit_width(count - 1)); i-- > 0;) {
    const bool settled = uint64_t{2 * symbol + 1} << i >= count;
    const bool bit = !settled && coder.decide(first + node, (chosen >> i & 1) != 0);
    symbol = 2 * symbol + (bit ? 1 : 0);
    node = 2 * node + (bit ? 1 : 0);
  }
  return symbol;
}
// One of `count` equally likely symbols.
template <typename Coder>
uint32_t codeEven(Coder& coder, uint32_t count, uint32_t chosen) {
  uint32_t symbol = 0;
  for (auto i = static_cast<unsigned>(std::bit_width(count - 1)); i-- > 0;) {
    const bool settled = uint64_t{2 * symbol + 1} << i >= count;
    const bool bit = !settled && coder.decide(kEvenContext, (chosen >> i & 1) != 0);
    symbol = 2 * symbol + (bit ? 1 : 0);
  }
  return symbol;
}

// Walks the ring. `entries`: at least two, cyclically adjacent ones different, none an ancestor of
// another. `gapKey(i)` gives the FaceKey of gap i; `positionOf(i, depth)` the position of entry i's
// ancestor-or-self at that depth, an optional or a pointer, without value for a virtual vertex.
// `Coder` codes decisions: bool decide(context, chosen) forward, bool decideBackward(context,
// chosen). An encoder is given `target` (entries) and returns `chosen`; a decoder, which says so by
// kDecodes, ignores both.
template <typename GapKey, typename PositionOf, typename Coder>
RingCut walkRing(std::span<const NodeId> entries, const GapKey& gapKey,
                 const PositionOf& positionOf, const CutFrame& frame, Coder& coder, RingCut target,
                 RingWalkSpace& space) {
  const auto size = static_cast<uint32_t>(entries.size());
  if (space.starts.size() < size) {
    space.starts.resize(2 * size_t{size});
    space.parting.resize(4 * size_t{size});
  }

  // The earliest parting around the ring and, among its gaps, the smallest face.
  int earliest = static_cast<int>(kMaxDepth) + 1;
  for (uint32_t i = 0; i < size; ++i) {
    const int depth = partingDepth(entries[i], entries[i + 1 == size ? 0 : i + 1]);
    space.parting[i] = space.parting[i + size] = depth;
    earliest = std::min(earliest, depth);
  }
  uint32_t smallest = size;
  FaceKey smallestKey;
  for (uint32_t i = 0; i < size; ++i) {
    if (space.parting[i] != earliest) continue;
    const FaceKey key = gapKey(i);
    if (smallest == size || key < smallestKey) {
      smallest = i;
      smallestKey = key;
    }
  }
  // From here on positions are counted from the entry behind that gap.
  const uint32_t origin = smallest + 1 == size ? 0 : smallest + 1;
  const int* const parting = space.parting.data() + origin;
  uint32_t* const starts = space.starts.data();
  uint32_t runs = 0;  // in `starts`
  const auto toPosition = [&](uint32_t entry) {
    return entry >= origin ? entry - origin : entry + size - origin;
  };
  const auto toEntry = [&](uint32_t position) {
    return position + origin < size ? position + origin : position + origin - size;
  };
  const uint32_t targetLeft = toPosition(target.left);
  const uint32_t targetRight = toPosition(target.right);

  struct Run {
    uint32_t begin, end;
    [[nodiscard]] bool single() const { return end - begin == 1; }
  };
  // Fills `starts` with the sub-runs of a run, given the depth at which they part.
  const auto cut = [&](Run run, int depth) {
    starts[0] = run.begin;
    runs = 1;
    for (uint32_t i = run.begin; i + 1 < run.end; ++i) {
      starts[runs] = i + 1;
      runs += parting[i] == depth ? 1 : 0;
    }
  };
  const auto earliestIn = [&](Run run) {
    int depth = parting[run.begin];
    for (uint32_t i = run.begin + 1; i + 1 < run.end; ++i) depth = std::min(depth, parting[i]);
    return depth;
  };
  const auto holder = [&](uint32_t position) -> uint32_t {
    if constexpr (Coder::kDecodes) return 0;
    const auto* above = std::upper_bound(starts, starts + runs, position);
    return above == starts ? 0 : static_cast<uint32_t>(above - starts - 1);
  };
  const auto runAt = [&](Run whole, uint32_t number) {
    return Run{starts[number], number + 1 == runs ? whole.end : starts[number + 1]};
  };
  // The place of the node that labels a sub-run.
  const auto placeOf = [&](uint32_t number, int depth) {
    return frame.place(positionOf(toEntry(starts[number]), static_cast<unsigned>(depth + 1)));
  };
  const auto pairPlaces = [&](int depth) {
    return frame.pairPlaces(placeOf(0, depth), placeOf(1, depth));
  };

  Run whole{0, size};
  cut(whole, earliest);
  uint32_t leftRun = holder(targetLeft);
  uint32_t rightRun = holder(targetRight);
  bool leftFirst = targetLeft < targetRight;
  if (runs <= kMaxRunsCoded) {
    const bool rightFirst = leftRun == rightRun && !leftFirst;
    const uint32_t symbol = codeSymbol(
        coder, cyclicContexts(runs, runs == 2 ? pairPlaces(earliest) : 0), runs * runs + runs,
        rightFirst ? runs * runs + leftRun : leftRun * runs + rightRun);
    const bool pair = symbol < runs * runs;
    leftRun = pair ? symbol / runs : symbol - runs * runs;
    rightRun = pair ? symbol % runs : symbol - runs * runs;
    leftFirst = pair;
  } else {
    leftRun = codeEven(coder, runs, leftRun);
    rightRun = codeEven(coder, runs, rightRun);
    leftFirst = leftRun != rightRun || coder.decide(kEvenContext, leftFirst);
  }
  Run left = runAt(whole, leftRun);
  Run right = runAt(whole, rightRun);
  while (left.begin == right.begin && !left.single()) {
    whole = left;
    const int depth = earliestIn(whole);
    cut(whole, depth);
    leftRun = holder(targetLeft);
    rightRun = holder(targetRight);
    uint32_t first = leftFirst ? leftRun : rightRun;
    uint32_t second = leftFirst ? rightRun : leftRun;
    if (runs <= kMaxRunsCoded) {
      // The pairs (0, 0), (0, 1), ..., (1, 1), ...
      const uint32_t symbol =
          codeSymbol(coder, linearContexts(runs, leftFirst, runs == 2 ? pairPlaces(depth) : 0),
                     runs * (runs + 1) / 2, first * (2 * runs - first + 1) / 2 + second - first);
      uint32_t rest = symbol;
      for (first = 0; rest >= runs - first; ++first) rest -= runs - first;
      second = first + rest;
    } else {
      first = codeEven(coder, runs, first);
      second = first + codeEven(coder, runs - first, second - first);
    }
    left = runAt(whole, leftFirst ? first : second);
    right = runAt(whole, leftFirst ? second : first);
  }
  if (left.begin != right.begin) {
    // t's faces lie clockwise of l and counter-clockwise of r.
    while (!left.single()) {
      const int depth = earliestIn(left);
      cut(left, depth);
      const uint32_t last = runs - 1;
      const uint32_t wanted = holder(targetLeft);
      uint32_t at = 0;
      for (auto near = placeOf(0, depth); at < last; ++at) {
        const auto far = placeOf(at + 1, depth);
        if (!coder.decide(stepContext(frame.stepPlaces(near, far, false)), wanted != at)) break;
        near = far;
      }
      left = runAt(left, at);
    }
    while (!right.single()) {
      const int depth = earliestIn(right);
      cut(right, depth);
      uint32_t at = runs - 1;
      const uint32_t wanted = holder(targetRight);
      for (auto near = placeOf(at, depth); at > 0; --at) {
        const auto far = placeOf(at - 1, depth);
        if (!coder.decideBackward(stepContext(frame.stepPlaces(near, far, true)), wanted != at))
          break;
        near = far;
      }
      right = runAt(right, at);
    }
  }
  return {toEntry(left.begin), toEntry(right.begin), leftFirst};
}

}  // namespace meshfront
