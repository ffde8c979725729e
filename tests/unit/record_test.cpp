#include "shared/codec/record.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/unit/small_tables.h"

namespace meshfront {
namespace {

using Bytes = std::vector<uint8_t>;

// 101 1 100000 011 11 0 110011
const Bytes kRecordBytes{0b10111000, 0b00011110, 0b11001100};
constexpr uint64_t kRecordBits = 22;

TEST(ValueClass, IsLengthAndSecondBit) {
  const std::vector<std::pair<int32_t, unsigned>> classes{
      {0, 0}, {1, 1}, {-1, 1}, {2, 2}, {3, 3}, {4, 4}, {5, 4}, {6, 5}, {-7, 5}, {8, 6}, {12, 7}};
  for (const auto& [value, expected] : classes) EXPECT_EQ(valueClassOf(value), expected) << value;
  EXPECT_EQ(valueClassOf((1 << 20) - 1), 39U);
  EXPECT_EQ(valueBits(0), 0U);
  EXPECT_EQ(valueBits(-3), 1U);
  EXPECT_EQ(valueBits(12), 3U);
}

TEST(Record, HasLiteralBytes) {
  const CodeTables tables = smallTables();
  Record record;
  record.leftIsLeaf = true;
  record.rightLevel = 1;
  record.deltaB = -5;
  record.deltaC = 0;
  record.residualA = 3;
  BitWriter out;
  writeRecordHead(out, record, 1, tables, 0);
  // Header: flags 2 (u is a leaf), class 1: symbol 5 of 8, all of 3 bits: 101. Level +1: 1.
  // Classes b 4, c 0: symbol 4 * 8 of 64: 100000. Residual's class 3 of 8: 011.
  // b: sign 1, open bit 1; c: nothing; a: sign 0. Region of 6 bits behind.
  EXPECT_EQ(out.bitCount(), 16U);
  out.write(0b110011, 6);
  const Bytes bytes = out.take();
  EXPECT_EQ(bytes, kRecordBytes);

  BitReader in(bytes, 0, kRecordBits);
  const Record back = readRecord(in, tables, 0);
  EXPECT_FALSE(in.overrun());
  EXPECT_TRUE(back.leftIsLeaf);
  EXPECT_FALSE(back.rightIsLeaf);
  EXPECT_EQ(back.rightLevel, 1);
  EXPECT_EQ(back.deltaB, -5);
  EXPECT_EQ(back.deltaC, 0);
  EXPECT_EQ(back.residualA, 3);
  EXPECT_EQ(back.cutBegin, 16U);
  EXPECT_EQ(back.cutEnd, kRecordBits);
  EXPECT_EQ(in.position(), kRecordBits);
}

TEST(Record, RefusesEveryTruncation) {
  const CodeTables tables = smallTables();
  for (uint64_t bits = 0; bits < kRecordBits; ++bits) {
    BitReader in(kRecordBytes, 0, bits);
    readRecord(in, tables, 0);
    EXPECT_TRUE(in.overrun()) << bits;
  }
}

TEST(Record, RefusesLevelsBeyondTheFinest) {
  const CodeTables tables = smallTables();
  BitReader in(kRecordBytes);
  readRecord(in, tables, tables.maxLevel);  // the same bits would name level maxLevel + 1
  EXPECT_TRUE(in.overrun());
}

TEST(Record, SurvivesAnyBytes) {
  const CodeTables tables = smallTables();
  std::mt19937_64 random(8);
  for (int round = 0; round < 20000; ++round) {
    Bytes bytes(random() % 9);
    for (auto& byte : bytes) byte = static_cast<uint8_t>(random());
    BitReader in(bytes);
    const Record record = readRecord(in, tables, static_cast<unsigned>(random() % 3));
    EXPECT_LE(record.cutBegin, record.cutEnd);
    EXPECT_LE(record.cutEnd, bytes.size() * 8);
    EXPECT_LE(record.leftLevel, tables.maxLevel);
  }
}

TEST(CodeTables, GoThroughTheWireAndRefuseDamage) {
  const CodeTables tables = smallTables();
  BitWriter out;
  writeCodeTables(out, tables);
  const Bytes bytes = out.take();
  BitReader in(bytes);
  const auto back = readCodeTables(in);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->maxLevel, tables.maxLevel);
  EXPECT_EQ(back->cutLengths, tables.cutLengths);
  BitWriter again;
  writeCodeTables(again, *back);
  EXPECT_EQ(again.take(), bytes);
  for (size_t length = 0; length + 1 < bytes.size(); ++length) {
    BitReader cut(bytes, 0, length * 8);
    EXPECT_FALSE(readCodeTables(cut)) << length;
  }
}

}  // namespace
}  // namespace meshfront
