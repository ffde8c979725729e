#include "shared/codec/record.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

namespace meshfront {
namespace {

// The value of a class: a sign, then the bits below the leading one.
int32_t readValue(BitReader& in, unsigned valueClass) {
  if (valueClass == 0) return 0;
  const auto bits = static_cast<uint32_t>(in.read(valueClass));
  const uint32_t top = 1U << (valueClass - 1);
  const auto magnitude = static_cast<int32_t>(top | (bits & (top - 1)));
  return (bits & top) != 0 ? -magnitude : magnitude;
}

void writeValue(BitWriter& out, int32_t value) {
  const unsigned valueClass = valueClassOf(value);
  if (valueClass == 0) return;
  const uint32_t top = 1U << (valueClass - 1);
  const uint32_t rest = static_cast<uint32_t>(std::abs(value)) & (top - 1);
  out.write((value < 0 ? top : 0) | rest, valueClass);
}

}  // namespace

unsigned valueClassOf(int32_t value) {
  return static_cast<unsigned>(std::bit_width(static_cast<uint32_t>(std::abs(value))));
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

  const auto readLevel = [&] {
    const unsigned child = level + tables.levels[context].read(in);
    if (child > tables.maxLevel) in.fail();
    return static_cast<uint8_t>(std::min(child, tables.maxLevel));
  };
  if (!record.leftIsLeaf) record.leftLevel = readLevel();
  if (!record.rightIsLeaf) record.rightLevel = readLevel();

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
  const unsigned leafFlags = (record.leftIsLeaf ? 2U : 0U) | (record.rightIsLeaf ? 1U : 0U);
  tables.header[context].write(out, tables.headerSymbol(leafFlags, cutClass));
  if (!record.leftIsLeaf) tables.levels[context].write(out, record.leftLevel - level);
  if (!record.rightIsLeaf) tables.levels[context].write(out, record.rightLevel - level);
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
