#include "shared/codec/cut_coding.h"

namespace meshfront {
namespace {

uint32_t cyclicSymbol(const CutSymbols::Symbol& s) {
  if (s.pair.left == s.pair.right && !s.leftFirst) return s.runs * s.runs + s.pair.left;
  return s.pair.left * s.runs + s.pair.right;
}
uint32_t linearSymbol(const CutSymbols::Symbol& s) {
  return s.pair.left * s.runs + s.pair.right;
}

void addAll(std::vector<uint64_t>& to, const std::vector<uint64_t>& from) {
  for (size_t i = 0; i < to.size(); ++i) to[i] += from[i];
}

}  // namespace

CutStatistics::CutStatistics() {
  for (size_t runs = 1; runs <= kMaxRunsCoded; ++runs) {
    cyclic[runs].assign(runs * runs + runs, 0);
    linear[linearTable(static_cast<uint32_t>(runs), false)].assign(runs * runs, 0);
    linear[linearTable(static_cast<uint32_t>(runs), true)].assign(runs * runs, 0);
  }
}

void CutStatistics::add(const CutSymbols& cut) {
  for (const auto& s : cut.symbols) {
    if (s.runs > kMaxRunsCoded) continue;
    if (s.kind == CutSymbols::Kind::cyclic) ++cyclic[s.runs][cyclicSymbol(s)];
    if (s.kind == CutSymbols::Kind::linear)
      ++linear[linearTable(s.runs, s.leftFirst)][linearSymbol(s)];
  }
}

void CutStatistics::add(const CutStatistics& other) {
  for (size_t i = 0; i < cyclic.size(); ++i) addAll(cyclic[i], other.cyclic[i]);
  for (size_t i = 0; i < linear.size(); ++i) addAll(linear[i], other.linear[i]);
}

void CutStatistics::train(CodeTables& tables) const {
  for (size_t i = 0; i < cyclic.size(); ++i)
    tables.cyclicRuns[i] = HuffmanCode::fromCounts(cyclic[i]);
  for (size_t i = 0; i < linear.size(); ++i)
    tables.linearRuns[i] = HuffmanCode::fromCounts(linear[i]);
}

void writeCut(CutBits& out, const CutSymbols& cut, const CodeTables& tables) {
  out.forward.clear();
  out.backward.clear();
  for (const auto& s : cut.symbols) {
    switch (s.kind) {
      case CutSymbols::Kind::cyclic:
        if (s.runs <= kMaxRunsCoded) {
          tables.cyclicRuns[s.runs].write(out.forward, cyclicSymbol(s));
        } else {
          writeTruncated(out.forward, s.pair.left, s.runs);
          writeTruncated(out.forward, s.pair.right, s.runs);
          if (s.pair.left == s.pair.right) out.forward.writeBit(s.leftFirst);
        }
        break;
      case CutSymbols::Kind::linear:
        if (s.runs <= kMaxRunsCoded) {
          tables.linearRuns[linearTable(s.runs, s.leftFirst)].write(out.forward, linearSymbol(s));
        } else {
          const uint32_t first = s.leftFirst ? s.pair.left : s.pair.right;
          const uint32_t second = s.leftFirst ? s.pair.right : s.pair.left;
          writeTruncated(out.forward, first, s.runs);
          writeTruncated(out.forward, second - first, s.runs - first);
        }
        break;
      case CutSymbols::Kind::left:
        writeTruncated(out.forward, s.pair.left, s.runs);
        break;
      case CutSymbols::Kind::right:
        writeTruncated(out.backward, s.pair.left, s.runs);
        break;
    }
  }
}

void appendRegion(BitWriter& out, const CutBits& bits, uint64_t length) {
  const auto forward = bits.forward.padded();
  const auto backward = bits.backward.padded();
  out.append(forward, 0, bits.forward.bitCount());
  for (uint64_t padding = length - bits.length(); padding > 0; --padding) out.writeBit(false);
  for (uint64_t i = bits.backward.bitCount(); i-- > 0;)
    out.writeBit((backward[i >> 3] >> (7 - (i & 7)) & 1) != 0);
}

}  // namespace meshfront
