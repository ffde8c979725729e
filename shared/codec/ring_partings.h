// Where neighbouring entries of a ring part, and the runs that the earliest partings cut it into:
// what walkRing() (ring_cut.h) asks over and over. Rings of up to 16 entries, all but a few in a
// thousand, are held in one vector register and asked without loops, so that nothing is guessed.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "shared/hierarchy/node_id.h"

namespace meshfront {

// The depth at which two entries part, counted from 1 on: their lowest common ancestor's, plus 1; 0
// for different trees. At most 64, as they are different.
[[nodiscard]] inline uint32_t partingDepth(const NodeId& a, const NodeId& b) {
  const auto depth = static_cast<uint32_t>(std::countl_zero(a.path ^ b.path)) + 1;
  return depth & (a.tree == b.tree ? UINT32_MAX : 0);
}

// Places in the ring from a first one on: [begin, end), which are entries.
struct RingRun {
  uint32_t begin, end;
  [[nodiscard]] bool single() const { return end - begin == 1; }
};

// Rings of any size.
class WidePartings {
 public:
  explicit WidePartings(std::span<const NodeId> entries)
      : size_(static_cast<uint32_t>(entries.size())), depths_(2 * entries.size()) {
    starts_.resize(entries.size() + 1);
    for (uint32_t i = 0; i < size_; ++i)
      depths_[i] = depths_[i + size_] =
          partingDepth(entries[i], entries[i + 1 == size_ ? 0 : i + 1]);
  }
  // The earliest depth at which neighbours part, all round.
  [[nodiscard]] uint32_t earliest() const {
    return *std::min_element(depths_.begin(), depths_.begin() + size_);
  }
  // visit(i) for each gap between entries i and i + 1 that part at that depth.
  template <typename Visit>
  void forEachGap(uint32_t depth, const Visit& visit) const {
    for (uint32_t i = 0; i < size_; ++i)
      if (depths_[i] == depth) visit(i);
  }
  // Runs are counted from this entry on from now on.
  void startAt(uint32_t entry) { origin_ = entry; }
  // The earliest depth at which neighbours within a run of several part.
  [[nodiscard]] uint32_t earliestIn(RingRun run) const {
    const uint32_t* const depths = depths_.data() + origin_;
    return *std::min_element(depths + run.begin, depths + run.end - 1);
  }
  // Cuts a run where neighbours part at a depth, of which there is one at least; the number of
  // sub-runs.
  uint32_t cut(RingRun run, uint32_t depth) {
    uint32_t runs = 1;
    starts_[0] = run.begin;
    for (uint32_t i = run.begin; i + 1 < run.end; ++i)
      if (depths_[origin_ + i] == depth) starts_[runs++] = i + 1;
    starts_[runs] = run.end;
    return runs;
  }
  // Sub-run `number` of the last cut.
  [[nodiscard]] RingRun run(uint32_t number) const {
    return {starts_[number], starts_[number + 1]};
  }

 private:
  uint32_t size_;
  uint32_t origin_ = 0;
  std::vector<uint32_t> depths_;  // [i]: between entries i and i + 1, twice round
  std::vector<uint32_t> starts_;
};

#ifdef __SSE2__
// Rings of up to kMost entries; does as WidePartings does.
class NarrowPartings {
 public:
  static constexpr size_t kMost = 16;

  explicit NarrowPartings(std::span<const NodeId> entries)
      : size_(static_cast<uint32_t>(entries.size())) {
    const NodeId* const at = entries.data();
    for (uint32_t i = 0; i + 1 < size_; ++i)
      depths_[i] = depths_[i + size_] = static_cast<uint8_t>(partingDepth(at[i], at[i + 1]));
    depths_[size_ - 1] = depths_[2 * size_ - 1] =
        static_cast<uint8_t>(partingDepth(at[size_ - 1], at[0]));
    startAt(0);
  }
  [[nodiscard]] uint32_t earliest() const { return least(only(lanes_, 0, size_)); }
  template <typename Visit>
  void forEachGap(uint32_t depth, const Visit& visit) const {
    for (uint32_t gaps = at(only(lanes_, 0, size_), depth); gaps != 0; gaps &= gaps - 1)
      visit(static_cast<uint32_t>(std::countr_zero(gaps)));
  }
  void startAt(uint32_t entry) {
    lanes_ = _mm_loadu_si128(reinterpret_cast<const __m128i*>(depths_.data() + entry));
  }
  [[nodiscard]] uint32_t earliestIn(RingRun run) const {
    return least(only(lanes_, run.begin, run.end - 1));
  }
  uint32_t cut(RingRun run, uint32_t depth) {
    uint32_t runs = 1;
    starts_[0] = run.begin;
    for (uint32_t gaps = at(only(lanes_, run.begin, run.end - 1), depth); gaps != 0;
         gaps &= gaps - 1)
      starts_[runs++] = static_cast<uint32_t>(std::countr_zero(gaps)) + 1;
    starts_[runs] = run.end;
    return runs;
  }
  [[nodiscard]] RingRun run(uint32_t number) const {
    return {starts_[number], starts_[number + 1]};
  }

 private:
  // Sixteen lanes without a depth between lanes with one; [32 - n ..] has n in front, [16 - n ..]
  // all but n behind.
  static constexpr std::array<uint8_t, 48> kOutside = [] {
    std::array<uint8_t, 48> lanes{};
    for (size_t i = 16; i < 32; ++i) lanes[i] = 0xFF;
    return lanes;
  }();

  // Lanes [begin, end) of them, the others without a depth.
  [[nodiscard]] static __m128i only(__m128i lanes, uint32_t begin, uint32_t end) {
    const __m128i before =
        _mm_loadu_si128(reinterpret_cast<const __m128i*>(kOutside.data() + 32 - begin));
    const __m128i behind =
        _mm_loadu_si128(reinterpret_cast<const __m128i*>(kOutside.data() + 16 - end));
    return _mm_or_si128(lanes, _mm_or_si128(before, behind));
  }
  [[nodiscard]] static uint32_t least(__m128i lanes) {
    lanes = _mm_min_epu8(lanes, _mm_srli_si128(lanes, 8));
    lanes = _mm_min_epu8(lanes, _mm_srli_si128(lanes, 4));
    lanes = _mm_min_epu8(lanes, _mm_srli_si128(lanes, 2));
    lanes = _mm_min_epu8(lanes, _mm_srli_si128(lanes, 1));
    return static_cast<uint32_t>(_mm_cvtsi128_si32(lanes)) & 0xFF;
  }
  // Lanes with that depth, as bits.
  [[nodiscard]] static uint32_t at(__m128i lanes, uint32_t depth) {
    return static_cast<uint32_t>(_mm_movemask_epi8(_mm_cmpeq_epi8(
        lanes, _mm_set1_epi64x(static_cast<int64_t>(depth * 0x0101010101010101ULL)))));
  }

  uint32_t size_;
  // [i]: between entries i and i + 1, twice round; never looked at behind that.
  std::array<uint8_t, 3 * kMost> depths_{};
  std::array<uint32_t, kMost + 1> starts_{};
  __m128i lanes_{};  // from the entry on at which runs start
};
#endif

}  // namespace meshfront
