// The codes of one mesh. Trained by the encoder, carried in the base resource.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shared/bits/bit_reader.h"
#include "shared/bits/bit_writer.h"
#include "shared/bits/huffman.h"
#include "shared/bits/two_ended_region.h"
#include "shared/codec/attribute_coding.h"
#include "shared/codec/cut_contexts.h"
#include "shared/result.h"

namespace meshfront {

inline constexpr unsigned kMaxLevel = 31;
inline constexpr unsigned kLevelCount = kMaxLevel + 1;

// Codes differ by how far a node's level is from the finest one: 0, 1, 2, 3 or more.
inline constexpr unsigned kLevelContexts = 4;
static_assert(kLevelContexts == kAttributeLevelContexts);
inline constexpr unsigned kMergedClasses = 2;
inline constexpr unsigned kResidualContexts = 32 / kMergedClasses * kLevelContexts;

// Of a decision of the cut code: the chance in 64 that it is 0, by context (cut_contexts.h).
using CutChances = std::array<uint8_t, kCutContexts + 1>;
[[nodiscard]] inline CutChances evenCutChances() {
  CutChances chances{};
  chances.fill(kEvenChance);
  return chances;
}

struct CodeTables {
  unsigned maxLevel = 0;      // finest significance level of any node, <= kMaxLevel
  unsigned valueClasses = 0;  // of d_b and d_c, see record.h: 2 x quantisation bits
  // Lengths in bits of the cut region, by leaf flags (u * 2 + t) and class; ascending, at
  // least 1: so every record takes a bit, and bytes bound the number of records.
  std::array<std::vector<uint16_t>, 4> cutLengths;
  std::array<HuffmanCode, kLevelContexts> header;  // symbols: (u, t, class) numbered in that order
  // Level of a child - own level: of the only child that is no leaf, or of both jointly.
  std::array<HuffmanCode, kLevelContexts> levels;
  std::array<HuffmanCode, kLevelContexts> levelPairs;   // u's * kLevelCount + t's
  std::array<HuffmanCode, kLevelContexts> classes;      // class b * valueClasses + class c
  std::array<HuffmanCode, kResidualContexts> residual;  // class of the residual of d_a
  CutChances cutChances = evenCutChances();             // 1 .. 63 each
  AttributeTables attributes;

  [[nodiscard]] unsigned levelContext(unsigned level) const {
    const unsigned distance = level > maxLevel ? 0 : maxLevel - level;
    return distance < kLevelContexts ? distance : kLevelContexts - 1;
  }
  // Given the larger of the classes of d_b and d_c.
  [[nodiscard]] static unsigned residualContext(unsigned largerClass, unsigned levelContext) {
    return (largerClass < 31 ? largerClass : 31) / kMergedClasses * kLevelContexts + levelContext;
  }
  // Number of a header symbol; leaf flags = u * 2 + t.
  [[nodiscard]] uint32_t headerSymbol(unsigned leafFlags, unsigned cutClass) const {
    uint32_t symbol = cutClass;
    for (unsigned i = 0; i < leafFlags; ++i) symbol += static_cast<uint32_t>(cutLengths[i].size());
    return symbol;
  }
  [[nodiscard]] size_t headerSymbols() const { return headerSymbol(4, 0); }
  [[nodiscard]] size_t memoryBytes() const {  // held beside the object itself
    size_t bytes = attributes.memoryBytes();
    for (const auto& lengths : cutLengths) bytes += lengths.capacity() * sizeof(uint16_t);
    for (const auto* codes : {&header, &levels, &levelPairs, &classes})
      for (const auto& code : *codes) bytes += code.memoryBytes();
    for (const auto& code : residual) bytes += code.memoryBytes();
    return bytes;
  }
  // The residual takes up to two bits more than a difference of two grid positions.
  [[nodiscard]] unsigned residualClasses() const { return valueClasses + 4; }
};

void writeCodeTables(BitWriter& out, const CodeTables& tables);
[[nodiscard]] Result<CodeTables> readCodeTables(BitReader& in);  // untrusted

}  // namespace meshfront
