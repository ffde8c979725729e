// Code tables of plain fixed-length codes, so that tests can write their bits by hand.
#pragma once

#include <vector>

#include "shared/codec/code_tables.h"

namespace meshfront {

// Header: 4 leaf flags x cut lengths {4, 6} = 8 symbols of 3 bits. Level differences 0 and 1: 1
// bit; pairs of them: 2 bits. Value classes: 8, pairs of them 6 bits. Residual classes 0 to 7: 3
// bits. Every decision of the cut code takes a bit. No attributes.
[[nodiscard]] inline CodeTables smallTables() {
  CodeTables tables;
  tables.maxLevel = 2;
  tables.valueClasses = 8;
  for (auto& lengths : tables.cutLengths) lengths = {4, 6};
  for (auto& code : tables.header) code = HuffmanCode::fromCounts(std::vector<uint64_t>(8, 1));
  std::vector<uint64_t> levels(kLevelCount, 0);
  levels[0] = levels[1] = 1;
  std::vector<uint64_t> pairs(kLevelCount * kLevelCount, 0);
  for (const unsigned u : {0U, 1U})
    for (const unsigned t : {0U, 1U}) pairs[u * kLevelCount + t] = 1;
  for (auto& code : tables.levels) code = HuffmanCode::fromCounts(levels);
  for (auto& code : tables.levelPairs) code = HuffmanCode::fromCounts(pairs);
  for (auto& code : tables.classes) code = HuffmanCode::fromCounts(std::vector<uint64_t>(64, 1));
  std::vector<uint64_t> residual(tables.residualClasses(), 0);
  for (size_t i = 0; i < 8; ++i) residual[i] = 1;
  for (auto& code : tables.residual) code = HuffmanCode::fromCounts(residual);
  return tables;
}

}  // namespace meshfront
