#include "shared/codec/code_tables.h"

#include "shared/bits/integer_codes.h"
#include "shared/mesh/quantization.h"

namespace meshfront {
namespace {

constexpr unsigned kClassCountBits = 5;
constexpr unsigned kCutLengthOrder = 2;
constexpr uint64_t kMaxCutLength = 4095;  // bits; the longest seen in practice is about 100

}  // namespace

void writeCodeTables(BitWriter& out, const CodeTables& tables) {
  out.write(tables.maxLevel, 5);
  out.write(tables.valueClasses, 6);
  for (const auto& lengths : tables.cutLengths) {
    out.write(lengths.size(), kClassCountBits);
    uint64_t next = 1;
    for (const uint16_t length : lengths) {
      writeExpGolomb(out, length - next, kCutLengthOrder);
      next = uint64_t{length} + 1;
    }
  }
  for (const auto& code : tables.header) code.writeTo(out);
  for (const auto& code : tables.levels) code.writeTo(out);
  for (const auto& code : tables.levelPairs) code.writeTo(out);
  for (const auto& code : tables.classes) code.writeTo(out);
  for (const auto& code : tables.residual) code.writeTo(out);
  for (unsigned runs = 2; runs <= kMaxRunsCoded; ++runs) {
    tables.cyclicRuns[runs].writeTo(out);
    tables.linearRuns[2 * runs].writeTo(out);
    tables.linearRuns[2 * runs + 1].writeTo(out);
  }
}

Result<CodeTables> readCodeTables(BitReader& in) {
  CodeTables tables;
  tables.maxLevel = static_cast<unsigned>(in.read(5));
  tables.valueClasses = static_cast<unsigned>(in.read(6));
  if (tables.valueClasses > 2 * kMaxQuantizationBits)
    return fail("code tables: values longer than any grid");
  for (auto& lengths : tables.cutLengths) {
    const uint64_t count = in.read(kClassCountBits);
    uint64_t next = 1;
    for (uint64_t i = 0; i < count; ++i) {
      const uint64_t length = next + readExpGolomb(in, kCutLengthOrder);
      if (length > kMaxCutLength) return fail("code tables: a cut region longer than any ring's");
      lengths.push_back(static_cast<uint16_t>(length));
      next = length + 1;
    }
  }
  for (auto& code : tables.header) code = HuffmanCode::readFrom(in, tables.headerSymbols());
  for (auto& code : tables.levels) code = HuffmanCode::readFrom(in, kLevelCount);
  for (auto& code : tables.levelPairs) code = HuffmanCode::readFrom(in, kLevelCount * kLevelCount);
  const size_t joint = size_t{tables.valueClasses} * tables.valueClasses;
  for (auto& code : tables.classes) code = HuffmanCode::readFrom(in, joint);
  for (auto& code : tables.residual) code = HuffmanCode::readFrom(in, tables.residualClasses());
  for (unsigned runs = 2; runs <= kMaxRunsCoded; ++runs) {
    tables.cyclicRuns[runs] = HuffmanCode::readFrom(in, size_t{runs} * runs + runs);
    tables.linearRuns[2 * runs] = HuffmanCode::readFrom(in, size_t{runs} * runs);
    tables.linearRuns[2 * runs + 1] = HuffmanCode::readFrom(in, size_t{runs} * runs);
  }
  if (in.overrun()) return fail("code tables: damaged or cut short");
  return tables;
}

}  // namespace meshfront
