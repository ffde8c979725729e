// The cut regions of all splits: static rings -> decisions -> chances -> shortest lengths ->
// regions.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "encoder/coding/closed_connectivity.h"
#include "encoder/coding/cut_archive.h"
#include "encoder/coding/split_fields.h"
#include "shared/bits/two_ended_region.h"

namespace meshfront {

class CutRegions {
 public:
  // Splits passed over; each is passed over three times.
  using Progress = std::function<void(uint64_t)>;

  // `baseNumber`: of the faces of the base mesh, by face. `threads` changes the time only. Holds
  // about 40 bytes a split.
  CutRegions(const CodingInput& input, const VertexForest& forest, const SplitFields& fields,
             const FaceOrigins& origins, const std::unordered_map<uint32_t, uint32_t>& baseNumber,
             unsigned threads, Progress progress);

  [[nodiscard]] const CutChances& chances() const { return chances_; }
  // Bits of the shortest region found, at least 1; by number in preorder.
  [[nodiscard]] uint16_t shortest(uint32_t split) const { return lengths_[split]; }
  // A length that any region can be made of.
  [[nodiscard]] uint16_t safe() const { return safe_; }

  // Makes all regions, each in the first length that it fits. `lengths` by leaf flags, ascending,
  // the last one at least safe(); `flagsOf(split)`.
  void fit(const std::array<std::vector<uint16_t>, 4>& lengths,
           const std::function<unsigned(uint32_t)>& flagsOf);
  // From then on: which length it was, and the region.
  [[nodiscard]] unsigned cutClass(uint32_t split) const { return classes_[split]; }
  void append(BitWriter& out, uint32_t split, unsigned length) const;

 private:
  void collect(const CodingInput& input, const VertexForest& forest, const SplitFields& fields,
               const FaceOrigins& origins,
               const std::unordered_map<uint32_t, uint32_t>& baseNumber);
  void shorten();

  unsigned threads_;
  Progress progress_;
  std::vector<CutArchive> blocks_;
  CutChances chances_{};
  std::vector<uint16_t> lengths_;
  std::vector<uint64_t> regions_;  // those of at most 64 bits
  uint16_t safe_ = 1;
  std::vector<uint8_t> classes_;
  std::unordered_map<uint32_t, std::vector<bool>> longRegions_;
};

}  // namespace meshfront
