// Coders for walkRing(): one that reads a record's cut region, one that collects an encoder's
// decisions, and how those become chances and regions.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/bits/two_ended_region.h"
#include "shared/codec/code_tables.h"
#include "shared/codec/cut_contexts.h"

namespace meshfront {

// Reads decisions from a cut region. Untrusted; any bits give some decisions.
class CutDecoder {
 public:
  static constexpr bool kDecodes = true;
  CutDecoder(const CodeTables& tables, std::span<const uint8_t> bytes, uint64_t begin, uint64_t end)
      : chances_(tables.cutChances), in_(bytes, begin, end) {}

  bool decide(unsigned context, bool) { return in_.forward(chances_[context]); }
  bool decideBackward(unsigned context, bool) { return in_.backward(chances_[context]); }

 private:
  const CutChances& chances_;
  TwoEndedReader in_;
};

struct CutDecision {
  uint16_t context = 0;
  bool bit = false;
  bool backward = false;
};

// Collects decisions, those of one direction in reading order.
class CutRecorder {
 public:
  static constexpr bool kDecodes = false;
  explicit CutRecorder(std::vector<CutDecision>& out) : out_(out) { out_.clear(); }
  bool decide(unsigned context, bool chosen) { return add(context, chosen, false); }
  bool decideBackward(unsigned context, bool chosen) { return add(context, chosen, true); }

 private:
  bool add(unsigned context, bool chosen, bool backward) {
    out_.push_back({static_cast<uint16_t>(context), chosen, backward});
    return chosen;
  }
  std::vector<CutDecision>& out_;
};

// How often each decision fell which way.
struct CutStatistics {
  std::array<std::array<uint64_t, 2>, kCutContexts + 1> counts{};

  void add(std::span<const CutDecision> cut);
  void add(const CutStatistics& other);
  // Chances that serve these counts, what they take in the tables included.
  [[nodiscard]] CutChances chances() const;
};

// The decisions as a region of bits in the making.
void writeCut(TwoEndedWriter& out, std::span<const CutDecision> cut, const CutChances& chances);

}  // namespace meshfront
