// The Huffman codes of one mesh. Trained by the encoder, carried in the base resource.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shared/bits/bit_reader.h"
#include "shared/bits/bit_writer.h"
#include "shared/bits/huffman.h"
#include "shared/result.h"

namespace meshfront {

inline constexpr unsigned kMaxLevel = 31;

// Codes differ by how far a node's level is from the finest one: 0, 1, 2, 3 or more.
inline constexpr unsigned kLevelContexts = 4;
inline constexpr unsigned kResidualContexts = 16 * kLevelContexts;
inline constexpr unsigned kMaxRunsCoded = 6;  // more cyclic runs than that: plain bits

struct CodeTables {
  unsigned maxLevel = 0;      // finest significance level of any node, <= kMaxLevel
  unsigned valueClasses = 0;  // bit lengths of d_b, d_c run below this (quantisation bits + 1)
  // Lengths in bits of the cut region, by leaf flags (u * 2 + t) and class; ascending, at
  // least 1: so every record takes a bit, and bytes bound the number of records.
  std::array<std::vector<uint16_t>, 4> cutLengths;
  std::array<HuffmanCode, kLevelContexts> header;   // symbols: (u, t, class) numbered in that order
  std::array<HuffmanCode, kLevelContexts> levels;   // level of child - own level
  std::array<HuffmanCode, kLevelContexts> classes;  // class b * valueClasses + class c
  std::array<HuffmanCode, kResidualContexts> residual;          // class of the residual of d_a
  std::array<HuffmanCode, kMaxRunsCoded + 1> cyclicRuns;        // [R]: run of l * R + run of r
  std::array<HuffmanCode, 2 * (kMaxRunsCoded + 1)> linearRuns;  // see cut_coding.h

  [[nodiscard]] unsigned levelContext(unsigned level) const {
    const unsigned distance = level > maxLevel ? 0 : maxLevel - level;
    return distance < kLevelContexts ? distance : kLevelContexts - 1;
  }
  // Given the larger of the classes of d_b and d_c.
  [[nodiscard]] static unsigned residualContext(unsigned largerClass, unsigned levelContext) {
    return (largerClass < 15 ? largerClass : 15) * kLevelContexts + levelContext;
  }
  // Number of a header symbol; leaf flags = u * 2 + t.
  [[nodiscard]] uint32_t headerSymbol(unsigned leafFlags, unsigned cutClass) const {
    uint32_t symbol = cutClass;
    for (unsigned i = 0; i < leafFlags; ++i) symbol += static_cast<uint32_t>(cutLengths[i].size());
    return symbol;
  }
  [[nodiscard]] size_t headerSymbols() const { return headerSymbol(4, 0); }
  // Classes of the residual: one more bit than a difference of the grid's ends has, and zero.
  [[nodiscard]] unsigned residualClasses() const { return valueClasses + 2; }
};

void writeCodeTables(BitWriter& out, const CodeTables& tables);
[[nodiscard]] Result<CodeTables> readCodeTables(BitReader& in);  // untrusted

}  // namespace meshfront
