#include "shared/codec/record.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

namespace meshfront {
namespace {

// Bits behind the sign that a class leaves open.
unsigned openBits(unsigned valueClass) {
  return valueClass < 4 ? 0 : valueClass / 2 - 1;
}

int32_t readValue(BitReader& in, unsigned valueClass) {
  if (valueClass == 0) return 0;
  const unsigned open = openBits(valueClass);
  const uint32_t lead = valueClass < 2 ? valueClass : 2U | (valueClass & 1U);
  const bool negative = in.readBit();
  const auto magnitude = static_cast<int32_t>(lead << open | static_cast<uint32_t>(in.read(open)));
  return negative ? -magnitude : magnitude;
}

void writeValue(BitWriter& out, int32_t value) {
  if (value == 0) return;
  out.writeBit(value < 0);
  out.write(static_cast<uint32_t>(std::abs(value)), openBits(valueClassOf(value)));
}

}  // namespace

unsigned valueClassOf(int32_t value) {
  const auto magnitude = static_cast<uint32_t>(std::abs(value));
  if (magnitude < 2) return magnitude;
  const auto length = static_cast<unsigned>(std::bit_width(magnitude));
  return 2 * (length - 1) + (magnitude >> (length - 2) & 1);
}

unsigned leafFlagsOf(const Record& record) {
  return (record.leftIsLeaf ? 2U : 0U) | (record.rightIsLeaf ? 1U : 0U);
}

uint32_t levelSymbol(const Record& record, unsigned level) {
  return (record.leftIsLeaf ? record.rightLevel : record.leftLevel) - level;
}

uint32_t levelPairSymbol(const Record& record, unsigned level) {
  return (record.leftLevel - level) * kLevelCount + record.rightLevel - level;
}

unsigned valueBits(int32_t value) {
  return value == 0 ? 0 : 1 + openBits(valueClassOf(value));
}

Record readRecord(BitReader& in, const CodeTables& tables, unsigned level) {
  Record record;
  const uint64_t begin = in.position();
  const unsigned context = tables.levelContext(level);

  uint32_t header = tables.header[context].read(in);
  unsigned leafFlags = 0;
  while (leafFlags < 3 && header >= tables.cutLengths[leafFlags].size())
    header -= static_cast<uint32_t>(tables.cutLengths[leafFlags++].size());
  record.leftIsLeaf = (leafFlags & 2) != 0;
  record.rightIsLeaf = (leafFlags & 1) != 0;

  const auto levelAbove = [&](unsigned difference) {
    if (level + difference > tables.maxLevel) in.fail();
    return static_cast<uint8_t>(std::min(level + difference, tables.maxLevel));
  };
  if (leafFlags == 0) {
    const uint32_t pair = tables.levelPairs[context].read(in);
    record.leftLevel = levelAbove(pair / kLevelCount);
    record.rightLevel = levelAbove(pair % kLevelCount);
  } else if (leafFlags < 3) {
    (record.leftIsLeaf ? record.rightLevel : record.leftLevel) =
        levelAbove(tables.levels[context].read(in));
  }

  const uint32_t joint = tables.classes[context].read(in);
  const unsigned classB = tables.valueClasses == 0 ? 0 : joint / tables.valueClasses;
  const unsigned classC = tables.valueClasses == 0 ? 0 : joint % tables.valueClasses;
  const unsigned classA =
      tables.residual[CodeTables::residualContext(std::max(classB, classC), context)].read(in);
  record.deltaB = readValue(in, classB);
  record.deltaC = readValue(in, classC);
  record.residualA = readValue(in, classA);

  const auto& lengths = tables.cutLengths[leafFlags];
  if (header >= lengths.size()) {
    in.fail();
  } else {
    record.cutBegin = static_cast<uint32_t>(in.position() - begin);
    in.skip(lengths[header]);
    record.cutEnd = static_cast<uint32_t>(in.position() - begin);
  }
  if (in.overrun()) record.cutBegin = record.cutEnd = 0;
  return record;
}

void writeRecordHead(BitWriter& out, const Record& record, unsigned cutClass,
                     const CodeTables& tables, unsigned level) {
  const unsigned context = tables.levelContext(level);
  const unsigned leafFlags = leafFlagsOf(record);
  tables.header[context].write(out, tables.headerSymbol(leafFlags, cutClass));
  if (leafFlags == 0) {
    tables.levelPairs[context].write(out, levelPairSymbol(record, level));
  } else if (leafFlags < 3) {
    tables.levels[context].write(out, levelSymbol(record, level));
  }
  const unsigned classB = valueClassOf(record.deltaB);
  const unsigned classC = valueClassOf(record.deltaC);
  tables.classes[context].write(out, classB * tables.valueClasses + classC);
  tables.residual[CodeTables::residualContext(std::max(classB, classC), context)].write(
      out, valueClassOf(record.residualA));
  writeValue(out, record.deltaB);
  writeValue(out, record.deltaC);
  writeValue(out, record.residualA);
}

}  // namespace meshfront
