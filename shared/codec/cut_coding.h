// The symbols of a cut code: how walkRing()'s choices become bits.
//
//   cyclic pair given R    <= kMaxRunsCoded: one Huffman symbol, l * R + r for different runs or
//                          l * R + l (l first) and R * R + l (r first) for the same one; else l and
//                          r in truncated binary codes and one bit for the order (1 = l first)
//   linear pair given R    <= kMaxRunsCoded: one Huffman symbol l * R + r, a code for each order;
//                          else the first, then the distance to the second, truncated binary
//   sub-run of l or r      truncated binary
#pragma once

#include <cstdint>
#include <vector>

#include "shared/bits/bit_reader.h"
#include "shared/bits/bit_writer.h"
#include "shared/bits/integer_codes.h"
#include "shared/codec/code_tables.h"
#include "shared/codec/ring_cut.h"

namespace meshfront {

// Index into CodeTables::linearRuns.
[[nodiscard]] inline uint32_t linearTable(uint32_t runs, bool leftFirst) {
  return runs * 2 + (leftFirst ? 1U : 0U);
}

// Reads choices from a cut region. Untrusted.
class CutDecoder {
 public:
  CutDecoder(const CodeTables& tables, std::span<const uint8_t> bytes, uint64_t begin, uint64_t end)
      : tables_(tables), forward_(bytes, begin, end), backward_(bytes, begin, end) {}

  RunPair cyclicPair(uint32_t runs, RunPair, bool& leftFirst) {
    if (runs <= kMaxRunsCoded) {
      const uint32_t symbol = tables_.cyclicRuns[runs].read(forward_);
      if (symbol >= runs * runs) {
        leftFirst = false;
        return {symbol - runs * runs, symbol - runs * runs};
      }
      leftFirst = true;
      return {symbol / runs, symbol % runs};
    }
    const uint32_t left = readTruncated(forward_, runs);
    const uint32_t right = readTruncated(forward_, runs);
    leftFirst = left != right || forward_.readBit();
    return {left, right};
  }
  RunPair linearPair(uint32_t runs, RunPair, bool leftFirst) {
    if (runs <= kMaxRunsCoded) {
      const uint32_t symbol = tables_.linearRuns[linearTable(runs, leftFirst)].read(forward_);
      return {symbol / runs, symbol % runs};
    }
    const uint32_t first = readTruncated(forward_, runs);
    const uint32_t second = first + readTruncated(forward_, runs - first);
    return leftFirst ? RunPair{first, second} : RunPair{second, first};
  }
  uint32_t leftRun(uint32_t runs, uint32_t) { return readTruncated(forward_, runs); }
  uint32_t rightRun(uint32_t runs, uint32_t) { return readTruncated(backward_, runs); }

  // No bit was read twice or beyond the region.
  [[nodiscard]] bool sound() const {
    return !forward_.overrun() && !backward_.overrun() &&
           forward_.position() <= backward_.position();
  }

 private:
  const CodeTables& tables_;
  BitReader forward_;
  BackwardBitReader backward_;
};

// A cut code as symbols, before the tables are trained.
struct CutSymbols {
  enum class Kind : uint8_t { cyclic, linear, left, right };
  struct Symbol {
    Kind kind = Kind::cyclic;
    bool leftFirst = false;
    uint32_t runs = 0;
    RunPair pair;
  };
  std::vector<Symbol> symbols;  // in the order chosen; reused between records
};

// Collects choices.
class CutRecorder {
 public:
  explicit CutRecorder(CutSymbols& out) : out_(out) { out_.symbols.clear(); }
  RunPair cyclicPair(uint32_t runs, RunPair chosen, bool& leftFirst) {
    add(CutSymbols::Kind::cyclic, runs, chosen, leftFirst);
    return chosen;
  }
  RunPair linearPair(uint32_t runs, RunPair chosen, bool leftFirst) {
    add(CutSymbols::Kind::linear, runs, chosen, leftFirst);
    return chosen;
  }
  uint32_t leftRun(uint32_t runs, uint32_t chosen) {
    add(CutSymbols::Kind::left, runs, {chosen, 0}, false);
    return chosen;
  }
  uint32_t rightRun(uint32_t runs, uint32_t chosen) {
    add(CutSymbols::Kind::right, runs, {chosen, 0}, false);
    return chosen;
  }

 private:
  void add(CutSymbols::Kind kind, uint32_t runs, RunPair pair, bool leftFirst) {
    out_.symbols.push_back({kind, leftFirst, runs, pair});
  }
  CutSymbols& out_;
};

// Counts of the coded symbols, to train tables.cyclicRuns and tables.linearRuns.
struct CutStatistics {
  std::array<std::vector<uint64_t>, kMaxRunsCoded + 1> cyclic;
  std::array<std::vector<uint64_t>, 2 * (kMaxRunsCoded + 1)> linear;

  CutStatistics();
  void add(const CutSymbols& cut);
  void add(const CutStatistics& other);
  void train(CodeTables& tables) const;
};

// The bits of a cut: `forward` holds the shared symbols and l's, `backward` r's in reading order.
struct CutBits {
  BitWriter forward;
  BitWriter backward;
  [[nodiscard]] uint64_t length() const { return forward.bitCount() + backward.bitCount(); }
};
void writeCut(CutBits& out, const CutSymbols& cut, const CodeTables& tables);

// Lays out a region of `length` bits, at least bits.length().
void appendRegion(BitWriter& out, const CutBits& bits, uint64_t length);

}  // namespace meshfront
