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

#include <bit>
#include <cstdint>
#include <span>

#include "shared/codec/cut_contexts.h"
#include "shared/codec/cut_frame.h"
#include "shared/codec/ring_partings.h"
#include "shared/hierarchy/node_id.h"

namespace meshfront {

// The total order of faces: base faces by index, then by the node that created the face (tree,
// path, depth), f_l first. Two words, since keys are compared where nobody can guess how it ends.
struct FaceKey {
  uint64_t high = 0;  // 0 for a base face, else the creator's tree + 1; then 31 bits of the path
  uint64_t low = 0;   // the others, then depth * 2 + (0 for f_l, 1 for f_r); a base face's index

  [[nodiscard]] static FaceKey ofBase(uint32_t index) { return {0, index}; }
  [[nodiscard]] static FaceKey of(const NodeId& creator, bool isRight) {
    return {(uint64_t{creator.tree} + 1) << 31 | creator.path >> 33,
            creator.path << 31 | uint64_t{creator.depth} * 2 | (isRight ? 1U : 0U)};
  }
  friend bool operator<(const FaceKey& a, const FaceKey& b) {
    return ((a.high < b.high ? 1U : 0U) |
            ((a.high == b.high ? 1U : 0U) & (a.low < b.low ? 1U : 0U))) != 0;
  }
};

struct RingCut {
  uint32_t left = 0;      // entry of the edge to l
  uint32_t right = 0;     // entry of the edge to r
  bool leftFirst = true;  // where both are the same edge: does l come before r in it?
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

// walkRing() for a ring that `Partings` can hold.
template <typename Partings, typename GapKey, typename PositionOf, typename Coder>
RingCut walkPartings(Partings partings, uint32_t size, const GapKey& gapKey,
                     const PositionOf& positionOf, const CutFrame& frame, Coder& coder,
                     RingCut target) {
  // The earliest parting around the ring and, among its gaps, the smallest face.
  uint32_t depth = partings.earliest();
  uint32_t smallest = size;
  FaceKey smallestKey;
  partings.forEachGap(depth, [&](uint32_t gap) {
    const FaceKey key = gapKey(gap);
    const bool smaller = smallest == size || key < smallestKey;
    smallest = smaller ? gap : smallest;
    smallestKey = smaller ? key : smallestKey;
  });
  // From here on positions are counted from the entry behind that gap.
  const uint32_t origin = smallest + 1 >= size ? 0 : smallest + 1;
  partings.startAt(origin);
  const auto toPosition = [&](uint32_t entry) {
    return entry >= origin ? entry - origin : entry + size - origin;
  };
  const auto toEntry = [&](uint32_t position) {
    return position + origin < size ? position + origin : position + origin - size;
  };
  const uint32_t targetLeft = toPosition(target.left);
  const uint32_t targetRight = toPosition(target.right);

  uint32_t runs = 0;  // of the last cut
  const auto holder = [&](uint32_t position) -> uint32_t {
    if constexpr (Coder::kDecodes) return 0;
    uint32_t number = 0;
    while (number + 1 < runs && partings.run(number + 1).begin <= position) ++number;
    return number;
  };
  // The place of the node that labels a sub-run.
  const auto placeOf = [&](uint32_t number) {
    return frame.place(positionOf(toEntry(partings.run(number).begin), depth));
  };
  const auto pairPlaces = [&] { return frame.pairPlaces(placeOf(0), placeOf(1)); };

  runs = partings.cut({0, size}, depth);
  uint32_t leftRun = holder(targetLeft);
  uint32_t rightRun = holder(targetRight);
  bool leftFirst = targetLeft < targetRight;
  if (runs <= kMaxRunsCoded) {
    const bool rightFirst = leftRun == rightRun && !leftFirst;
    const uint32_t symbol =
        codeSymbol(coder, cyclicContexts(runs, runs == 2 ? pairPlaces() : 0), runs * runs + runs,
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
  RingRun left = partings.run(leftRun);
  RingRun right = partings.run(rightRun);
  while (left.begin == right.begin && !left.single()) {
    depth = partings.earliestIn(left);
    runs = partings.cut(left, depth);
    leftRun = holder(targetLeft);
    rightRun = holder(targetRight);
    uint32_t first = leftFirst ? leftRun : rightRun;
    uint32_t second = leftFirst ? rightRun : leftRun;
    if (runs <= kMaxRunsCoded) {
      // The pairs (0, 0), (0, 1), ..., (1, 1), ...
      const uint32_t symbol =
          codeSymbol(coder, linearContexts(runs, leftFirst, runs == 2 ? pairPlaces() : 0),
                     runs * (runs + 1) / 2, first * (2 * runs - first + 1) / 2 + second - first);
      uint32_t rest = symbol;
      for (first = 0; rest >= runs - first; ++first) rest -= runs - first;
      second = first + rest;
    } else {
      first = codeEven(coder, runs, first);
      second = first + codeEven(coder, runs - first, second - first);
    }
    left = partings.run(leftFirst ? first : second);
    right = partings.run(leftFirst ? second : first);
  }
  if (left.begin != right.begin) {
    // t's faces lie clockwise of l and counter-clockwise of r.
    while (!left.single()) {
      depth = partings.earliestIn(left);
      runs = partings.cut(left, depth);
      const uint32_t last = runs - 1;
      const uint32_t wanted = holder(targetLeft);
      uint32_t at = 0;
      for (auto near = placeOf(0); at < last; ++at) {
        const auto far = placeOf(at + 1);
        if (!coder.decide(stepContext(frame.stepPlaces(near, far, false)), wanted != at)) break;
        near = far;
      }
      left = partings.run(at);
    }
    while (!right.single()) {
      depth = partings.earliestIn(right);
      runs = partings.cut(right, depth);
      uint32_t at = runs - 1;
      const uint32_t wanted = holder(targetRight);
      for (auto near = placeOf(at); at > 0; --at) {
        const auto far = placeOf(at - 1);
        if (!coder.decideBackward(stepContext(frame.stepPlaces(near, far, true)), wanted != at))
          break;
        near = far;
      }
      right = partings.run(at);
    }
  }
  return {toEntry(left.begin), toEntry(right.begin), leftFirst};
}

// Walks the ring. `entries`: at least two, cyclically adjacent ones different, none an ancestor of
// another. `gapKey(i)` gives the FaceKey of gap i; `positionOf(i, depth)` the position of entry i's
// ancestor-or-self at that depth, an optional or a pointer, without value for a virtual vertex.
// `Coder` codes decisions: bool decide(context, chosen) forward, bool decideBackward(context,
// chosen). An encoder is given `target` (entries) and returns `chosen`; a decoder, which says so by
// kDecodes, ignores both.
template <typename GapKey, typename PositionOf, typename Coder>
RingCut walkRing(std::span<const NodeId> entries, const GapKey& gapKey,
                 const PositionOf& positionOf, const CutFrame& frame, Coder& coder,
                 RingCut target) {
  const auto size = static_cast<uint32_t>(entries.size());
#ifdef __SSE2__
  if (size <= NarrowPartings::kMost)
    return walkPartings(NarrowPartings(entries), size, gapKey, positionOf, frame, coder, target);
#endif
  return walkPartings(WidePartings(entries), size, gapKey, positionOf, frame, coder, target);
}

}  // namespace meshfront
