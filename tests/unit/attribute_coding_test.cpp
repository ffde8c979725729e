#include "shared/codec/attribute_coding.h"

#include <gtest/gtest.h>

#include <random>

namespace meshfront {
namespace {

using Bytes = std::vector<uint8_t>;

VertexAttributes attributes(Colour colour, OctahedralNormal normal) {
  return {colour, normal};
}

AttributeTables trained(const AttributeLayout& layout, const std::vector<AttributeDelta>& deltas) {
  AttributeStatistics statistics(layout);
  for (size_t i = 0; i < deltas.size(); ++i)
    statistics.add(deltas[i], static_cast<unsigned>(i % kAttributeLevelContexts));
  return statistics.train();
}

TEST(AttributeCoding, TellsColoursByGreen) {
  const auto delta = attributeDelta(attributes({10, 20, 30, 255}, {100, 200}),
                                    attributes({13, 25, 28, 250}, {101, 190}));
  EXPECT_EQ(delta.colour, (std::array<int16_t, 4>{5, -2, -7, -5}));
  EXPECT_EQ(delta.normal, (std::array<int16_t, 2>{1, -10}));
}

TEST(AttributeCoding, HasLiteralBits) {
  // Two equally frequent values a field: a code of one bit each, in the order of the classes.
  const AttributeLayout layout{true, 4};
  std::vector<AttributeDelta> both;
  for (unsigned i = 0; i < kAttributeLevelContexts; ++i) both.push_back({{0, 0, 0, 0}, {0, 0}});
  for (unsigned i = 0; i < kAttributeLevelContexts; ++i) both.push_back({{1, -1, 3, -4}, {-2, 1}});
  const AttributeTables tables = trained(layout, both);
  BitWriter out;
  writeAttributes(out, both.back(), tables, 3);
  // Classes 1 1 1 1, green + 1: 0, red -1: 1, blue 3: 0, alpha -4: 1 0; normal's class 1, -2: 1,
  // 1: 0.
  EXPECT_EQ(out.bitCount(), 12U);
  const Bytes bytes = out.take();
  EXPECT_EQ(bytes, (Bytes{0b11110101, 0b01100000}));
  const AttributeBits bits = attributeBits(both.back(), tables, 3);
  EXPECT_EQ(bits.colour, 9U);
  EXPECT_EQ(bits.normal, 3U);
  BitReader in(bytes, 0, 12);
  const AttributeDelta back = readAttributes(in, tables, 3);
  EXPECT_FALSE(in.overrun());
  EXPECT_EQ(back.colour, both.back().colour);
  EXPECT_EQ(back.normal, both.back().normal);
  for (uint64_t end = 0; end < 12; ++end) {
    BitReader cut(bytes, 0, end);
    readAttributes(cut, tables, 3);
    EXPECT_TRUE(cut.overrun()) << end;
  }
}

TEST(AttributeCoding, ReturnsEveryPairOfAttributes) {
  std::mt19937 random(9);
  for (const unsigned normalBits : {4U, 10U, 15U}) {
    const AttributeLayout layout{true, normalBits};
    std::vector<VertexAttributes> values(400);
    for (auto& v : values) {
      for (auto& channel : v.colour)
        channel = random() % 4 == 0 ? static_cast<uint8_t>(255 * (random() % 2))
                                    : static_cast<uint8_t>(random());
      for (auto& x : v.normal) x = static_cast<uint16_t>(random() % (1U << normalBits));
    }
    std::vector<AttributeDelta> deltas;
    for (size_t i = 1; i < values.size(); ++i)
      deltas.push_back(attributeDelta(values[i - 1], values[i]));
    const AttributeTables tables = trained(layout, deltas);
    BitWriter tableBits;
    writeAttributeTables(tableBits, tables);
    const Bytes tableBytes = tableBits.take();
    BitReader tableReader(tableBytes);
    AttributeTables sent;
    ASSERT_TRUE(readAttributeTables(tableReader, sent));
    EXPECT_EQ(sent.layout, layout);
    BitWriter out;
    for (size_t i = 0; i < deltas.size(); ++i)
      writeAttributes(out, deltas[i], tables, static_cast<unsigned>(i % kAttributeLevelContexts));
    const Bytes bytes = out.take();
    BitReader in(bytes);
    for (size_t i = 0; i < deltas.size(); ++i) {
      const auto delta =
          readAttributes(in, sent, static_cast<unsigned>(i % kAttributeLevelContexts));
      VertexAttributes back;
      ASSERT_TRUE(addAttributes(values[i], delta, layout, back));
      ASSERT_EQ(back, values[i + 1]);
    }
    EXPECT_FALSE(in.overrun());
  }
}

TEST(AttributeCoding, RefusesWhatLeavesItsRange) {
  const AttributeLayout layout{true, 4};
  VertexAttributes out;
  const VertexAttributes s = attributes({250, 5, 0, 255}, {15, 0});
  EXPECT_TRUE(addAttributes(s, {{0, 5, 0, 0}, {0, 0}}, layout, out));
  EXPECT_FALSE(addAttributes(s, {{0, 6, 0, 0}, {0, 0}}, layout, out));
  EXPECT_FALSE(addAttributes(s, {{-6, 0, 0, 0}, {0, 0}}, layout, out));
  EXPECT_FALSE(addAttributes(s, {{0, 0, 0, 1}, {0, 0}}, layout, out));
  EXPECT_FALSE(addAttributes(s, {{0, 0, 0, 0}, {1, 0}}, layout, out));
  EXPECT_FALSE(addAttributes(s, {{0, 0, 0, 0}, {0, -1}}, layout, out));
}

TEST(AttributeTables, RefuseLayoutsOfOtherVersions) {
  const auto reads = [](uint8_t first) {
    AttributeTables tables;
    const Bytes bytes{first, 0, 0, 0};
    BitReader in(bytes);
    return readAttributeTables(in, tables);
  };
  EXPECT_TRUE(reads(0b0'0000'0'00));
  EXPECT_FALSE(reads(0b0'0000'1'00));  // further attributes
  EXPECT_FALSE(reads(0b0'0011'0'00));  // normals of 3 bits
}

}  // namespace
}  // namespace meshfront
