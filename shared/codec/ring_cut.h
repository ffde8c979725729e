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
// first.
// 3. While l and r share a run of several entries: the gaps in it that part earliest cut it into R
//    sub-runs; one symbol given R and the order: the sub-runs of l and of r.
// 4. Then l alone: while its run has several entries, the number of its sub-run in a truncated
//    binary code, read forward. The same for r, read backward from the end of the region.
//
// Region: [shared symbols][l forward][padding][r backward]. Encoder and decoder are one template.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

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

struct RunPair {
  uint32_t left = 0;
  uint32_t right = 0;
};

// Working space of the walk, kept between calls so that it allocates nothing.
struct RingWalkSpace {
  std::vector<int> parting;      // [i]: between entries i and i + 1 of the rotated ring
  std::vector<uint32_t> starts;  // of runs
};

// Walks the ring. `entries`: at least two, cyclically adjacent ones different, none an ancestor of
// another. `gapKey(i)` gives the FaceKey of gap i. `Coder` chooses or reads:
//   RunPair cyclicPair(runs, chosen, bool& leftFirst), leftFirst told only where both are one run;
//   RunPair linearPair(runs, chosen, leftFirst);
//   uint32_t leftRun(runs, chosen), rightRun(runs, chosen).
// An encoder is given `target` (entries) and returns `chosen`; a decoder ignores both. Choices must
// be below `runs`, and in linearPair in the order that leftFirst says.
template <typename GapKey, typename Coder>
RingCut walkRing(std::span<const NodeId> entries, const GapKey& gapKey, Coder& coder,
                 RingCut target, RingWalkSpace& space) {
  const auto size = static_cast<uint32_t>(entries.size());
  auto& parting = space.parting;
  auto& starts = space.starts;

  // The earliest parting around the ring and, among its gaps, the smallest face.
  int earliest = static_cast<int>(kMaxDepth) + 1;
  parting.resize(size);
  for (uint32_t i = 0; i < size; ++i) {
    parting[i] = partingDepth(entries[i], entries[i + 1 == size ? 0 : i + 1]);
    earliest = std::min(earliest, parting[i]);
  }
  uint32_t smallest = size;
  FaceKey smallestKey;
  for (uint32_t i = 0; i < size; ++i) {
    if (parting[i] != earliest) continue;
    const FaceKey key = gapKey(i);
    if (smallest == size || key < smallestKey) {
      smallest = i;
      smallestKey = key;
    }
  }
  // From here on positions are counted from the entry behind that gap.
  const uint32_t origin = smallest + 1 == size ? 0 : smallest + 1;
  std::rotate(parting.begin(), parting.begin() + origin, parting.end());
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
    starts.clear();
    starts.push_back(run.begin);
    for (uint32_t i = run.begin; i + 1 < run.end; ++i)
      if (parting[i] == depth) starts.push_back(i + 1);
    return static_cast<uint32_t>(starts.size());
  };
  const auto cutEarliest = [&](Run run) {
    int depth = parting[run.begin];
    for (uint32_t i = run.begin + 1; i + 1 < run.end; ++i) depth = std::min(depth, parting[i]);
    return cut(run, depth);
  };
  const auto holder = [&](uint32_t position) {
    const auto above = std::upper_bound(starts.begin(), starts.end(), position);
    return above == starts.begin() ? 0 : static_cast<uint32_t>(above - starts.begin() - 1);
  };
  const auto runAt = [&](Run whole, uint32_t number) {
    const bool last = number + 1 == starts.size();
    return Run{starts[number], last ? whole.end : starts[number + 1]};
  };

  Run whole{0, size};
  uint32_t runs = cut(whole, earliest);
  bool leftFirst = targetLeft < targetRight;
  RunPair pair =
      coder.cyclicPair(runs, RunPair{holder(targetLeft), holder(targetRight)}, leftFirst);
  Run left = runAt(whole, pair.left);
  Run right = runAt(whole, pair.right);
  while (left.begin == right.begin && !left.single()) {
    whole = left;
    runs = cutEarliest(whole);
    pair = coder.linearPair(runs, RunPair{holder(targetLeft), holder(targetRight)}, leftFirst);
    left = runAt(whole, pair.left);
    right = runAt(whole, pair.right);
  }
  if (left.begin != right.begin) {
    while (!left.single()) {
      runs = cutEarliest(left);
      left = runAt(left, coder.leftRun(runs, holder(targetLeft)));
    }
    while (!right.single()) {
      runs = cutEarliest(right);
      right = runAt(right, coder.rightRun(runs, holder(targetRight)));
    }
  }
  return {toEntry(left.begin), toEntry(right.begin), leftFirst};
}

}  // namespace meshfront
