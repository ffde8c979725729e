#include "shared/codec/record.h"

#include <algorithm>

namespace meshfront {
unsigned leafFlagsOf(const Record& record) {
  return (record.leftIsLeaf ? 2U : 0U) | (record.rightIsLeaf ? 1U : 0U);
}

uint32_t levelSymbol(const Record& record, unsigned level) {
  return (record.leftIsLeaf ? record.rightLevel : record.leftLevel) - level;
}

uint32_t levelPairSymbol(const Record& record, unsigned level) {
  return (record.leftLevel - level) * kLevelCount + record.rightLevel - level;
}

namespace {

// Everything in front of attributes and cut region; returns the cut region's class.
template <typename Reader>
uint32_t readHead(Reader& in, const CodeTables& tables, unsigned level, Record& record) {
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
  return header;
}

}  // namespace

Record readRecord(BitReader& in, const CodeTables& tables, unsigned level) {
  Record record;
  const uint64_t begin = in.position();
  BitWindow window(in);
  uint32_t cutClass = readHead(window, tables, level, record);
  if (window.sufficed()) {
    in.skip(window.used());
  } else {  // a very long one, or a damaged one
    record = Record();
    cutClass = readHead(in, tables, level, record);
  }
  if (tables.attributes.layout.any())
    record.attributes = readAttributes(in, tables.attributes, tables.levelContext(level));

  const auto& lengths = tables.cutLengths[leafFlagsOf(record)];
  if (cutClass >= lengths.size()) {
    in.fail();
  } else {
    record.cutBegin = static_cast<uint32_t>(in.position() - begin);
    in.skip(lengths[cutClass]);
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
  if (tables.attributes.layout.any())
    writeAttributes(out, record.attributes, tables.attributes, context);
}

}  // namespace meshfront
