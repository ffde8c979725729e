#include "shared/codec/code_tables.h"

#include "shared/bits/integer_codes.h"
#include "shared/bits/two_ended_region.h"
#include "shared/mesh/quantization.h"

namespace meshfront {
namespace {

constexpr unsigned kClassCountBits = 5;
constexpr unsigned kCutLengthOrder = 2;
constexpr uint64_t kMaxCutLength = 4095;  // bits; the longest seen in practice is about 100

// Runs of equal chances, and how far the next one is from them.
void writeCutChances(BitWriter& out, const CutChances& chances) {
  unsigned last = kEvenChance;
  uint64_t equal = 0;
  for (unsigned i = 0; i < kCutContexts; ++i) {
    if (chances[i] == last) {
      ++equal;
      continue;
    }
    writeExpGolomb(out, equal, 1);
    const bool down = chances[i] < last;
    out.writeBit(down);
    writeExpGolomb(out, (down ? last - chances[i] : chances[i] - last) - 1, 1);
    last = chances[i];
    equal = 0;
  }
  if (equal > 0) writeExpGolomb(out, equal, 1);
}

bool readCutChances(BitReader& in, CutChances& chances) {
  unsigned last = kEvenChance;
  unsigned i = 0;
  while (i < kCutContexts && !in.overrun()) {
    const uint64_t equal = readExpGolomb(in, 1);
    if (equal > kCutContexts - i) return false;
    for (const unsigned end = i + static_cast<unsigned>(equal); i < end; ++i)
      chances[i] = static_cast<uint8_t>(last);
    if (i == kCutContexts) break;
    const bool down = in.readBit();
    const uint64_t distance = readExpGolomb(in, 1) + 1;
    if (distance >= (down ? last : (1U << kChanceBits) - last)) return false;
    last = down ? last - static_cast<unsigned>(distance) : last + static_cast<unsigned>(distance);
    chances[i++] = static_cast<uint8_t>(last);
  }
  chances[kEvenContext] = kEvenChance;
  return true;
}

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
  writeCutChances(out, tables.cutChances);
  writeAttributeTables(out, tables.attributes);
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
  if (!readCutChances(in, tables.cutChances)) return fail("code tables: an impossible chance");
  if (!readAttributeTables(in, tables.attributes))
    return fail("code tables: attributes that this version does not know; update the viewer");
  if (in.overrun()) return fail("code tables: damaged or cut short");
  return tables;
}

}  // namespace meshfront
