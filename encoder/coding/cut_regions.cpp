#include "encoder/coding/cut_regions.h"

#include <algorithm>
#include <mutex>

#include "encoder/coding/parallel_blocks.h"
#include "encoder/coding/static_ring.h"

namespace meshfront {
namespace {

constexpr unsigned kWordBits = 64;

uint64_t asWord(const TwoEndedWriter::Region& region) {
  uint64_t word = 0;
  for (const bool bit : region) word = word << 1 | (bit ? 1 : 0);
  return word;
}

}  // namespace

CutRegions::CutRegions(const CodingInput& input, const VertexForest& forest,
                       const SplitFields& fields, const FaceOrigins& origins,
                       const std::unordered_map<uint32_t, uint32_t>& baseNumber, unsigned threads,
                       Progress progress)
    : threads_(threads),
      progress_(std::move(progress)),
      blocks_(blockCount(forest.splitCount())),
      lengths_(forest.splitCount()),
      regions_(forest.splitCount()) {
  collect(input, forest, fields, origins, baseNumber);
  shorten();
}

void CutRegions::collect(const CodingInput& input, const VertexForest& forest,
                         const SplitFields& fields, const FaceOrigins& origins,
                         const std::unordered_map<uint32_t, uint32_t>& baseNumber) {
  const auto twins = twinsOf(input.triangles, forest.leafCount());
  const auto keyOf = [&](uint32_t face) {
    const ForestNode creator = origins.creator[face];
    if (creator == kNoNode) return FaceKey::ofBase(baseNumber.at(face));
    return FaceKey::of(forest.id(creator), origins.rightFace[creator - forest.leafCount()] == face);
  };
  CutStatistics statistics;
  std::mutex adding;
  const auto work = [&](uint32_t block, uint32_t begin, uint32_t end) {
    StaticRing ring;
    std::vector<CutDecision> cut;
    std::vector<NodeId> entries;
    CutStatistics counts;
    const auto positionOf = [&](uint32_t entry, unsigned depth) -> std::optional<GridPosition> {
      ForestNode node = ring.leaves[entry];
      if (node >= input.positions.size()) return std::nullopt;
      for (unsigned steps = entries[entry].depth - depth; steps > 0; --steps)
        node = forest.parent(node);
      return fields.position(node);
    };
    for (uint32_t i = begin; i < end; ++i) {
      const ForestNode node = forest.splitsInPreorder()[i];
      walkStaticRing(node, input.triangles, twins, forest, origins, ring);
      entries.clear();
      for (const uint32_t leaf : ring.leaves) entries.push_back(forest.id(leaf));
      CutRecorder recorder(cut);
      walkRing(
          std::span<const NodeId>(entries), [&](uint32_t gap) { return keyOf(ring.gaps[gap]); },
          positionOf, CutFrame(fields.position(node), fields.delta(node), fields.normal(node)),
          recorder, RingCut{0, ring.right, true});
      counts.add(cut);
      blocks_[block].append(cut);
    }
    const std::lock_guard lock(adding);
    statistics.add(counts);
  };
  forEachBlock(forest.splitCount(), threads_, work, progress_);
  chances_ = statistics.chances();
}

void CutRegions::shorten() {
  const auto splits = static_cast<uint32_t>(lengths_.size());
  std::mutex adding;
  const auto work = [&](uint32_t block, uint32_t begin, uint32_t end) {
    std::vector<CutDecision> cut;
    TwoEndedWriter writer;
    size_t position = 0;
    unsigned longest = 1;
    for (uint32_t i = begin; i < end; ++i) {
      blocks_[block].read(position, cut);
      writeCut(writer, cut, chances_);
      lengths_[i] = static_cast<uint16_t>(writer.shortestLength());
      if (lengths_[i] <= kWordBits) regions_[i] = asWord(*writer.ofLength(lengths_[i]));
      longest = std::max(longest, writer.safeLength());
    }
    const std::lock_guard lock(adding);
    safe_ = std::max(safe_, static_cast<uint16_t>(longest));
  };
  forEachBlock(splits, threads_, work, [&](uint64_t begun) { progress_(splits + begun); });
}

void CutRegions::fit(const std::array<std::vector<uint16_t>, 4>& lengths,
                     const std::function<unsigned(uint32_t)>& flagsOf) {
  const auto splits = static_cast<uint32_t>(lengths_.size());
  classes_.resize(splits);
  std::mutex adding;
  const auto work = [&](uint32_t block, uint32_t begin, uint32_t end) {
    std::vector<CutDecision> cut;
    TwoEndedWriter writer;
    size_t position = 0;
    for (uint32_t i = begin; i < end; ++i) {
      blocks_[block].read(position, cut);
      const auto& choice = lengths[flagsOf(i)];
      auto length = std::lower_bound(choice.begin(), choice.end(), lengths_[i]);
      if (*length == lengths_[i] && *length <= kWordBits) {
        classes_[i] = static_cast<uint8_t>(length - choice.begin());
        continue;  // made already
      }
      writeCut(writer, cut, chances_);
      auto region = writer.ofLength(*length);
      while (!region) region = writer.ofLength(*++length);
      classes_[i] = static_cast<uint8_t>(length - choice.begin());
      if (region->size() <= kWordBits) {
        regions_[i] = asWord(*region);
      } else {
        const std::lock_guard lock(adding);
        longRegions_[i] = std::move(*region);
      }
    }
    blocks_[block] = {};
  };
  forEachBlock(splits, threads_, work, [&](uint64_t begun) { progress_(2 * splits + begun); });
}

void CutRegions::append(BitWriter& out, uint32_t split, unsigned length) const {
  if (length > kWordBits) {
    for (const bool bit : longRegions_.at(split)) out.writeBit(bit);
    return;
  }
  constexpr unsigned kHalf = kWordBits / 2;
  if (length > kHalf) out.write(regions_[split] >> kHalf, length - kHalf);
  out.write(regions_[split], std::min(length, kHalf));
}

}  // namespace meshfront
