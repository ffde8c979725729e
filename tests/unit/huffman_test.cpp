#include "shared/bits/huffman.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace meshfront {
namespace {

using Bytes = std::vector<uint8_t>;

HuffmanCode throughTheWire(const HuffmanCode& code) {
  BitWriter out;
  code.writeTo(out);
  const uint64_t bits = out.bitCount();
  const Bytes bytes = out.take();
  BitReader in(bytes);
  HuffmanCode back = HuffmanCode::readFrom(in, code.symbols());
  EXPECT_FALSE(in.overrun());
  EXPECT_EQ(in.position(), bits);
  return back;
}

TEST(HuffmanCode, IsCanonicalAndOptimal) {
  const std::vector<uint64_t> counts{5, 0, 1, 1, 2};
  const auto code = HuffmanCode::fromCounts(counts);
  EXPECT_EQ(code.length(0), 1U);
  EXPECT_EQ(code.length(4), 2U);
  EXPECT_EQ(code.length(2), 3U);
  EXPECT_EQ(code.length(3), 3U);
  EXPECT_FALSE(code.has(1));
  BitWriter out;
  for (const size_t symbol : {0, 4, 2, 3}) code.write(out, symbol);  // 0 10 110 111
  EXPECT_EQ(out.take(), (Bytes{0b01011011, 0b10000000}));
}

TEST(HuffmanCode, WiresItsLengths) {
  // 4 symbols (Exp-Golomb 3: 1100); gap 0, length 1 (-3: zigzag 5); gap 1, 3 (+2: 4); gap 0, 3 (0);
  // gap 0, 2 (-1: 1).
  BitWriter out;
  HuffmanCode::fromCounts(std::vector<uint64_t>{5, 0, 1, 1, 2}).writeTo(out);
  EXPECT_EQ(out.bitCount(), 24U);
  EXPECT_EQ(out.take(), (Bytes{0b11001001, 0b10010001, 0b01111010}));
}

TEST(HuffmanCode, ReadsBackEverySymbol) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 60; ++round) {
    std::vector<uint64_t> counts(1 + random() % 700);
    for (auto& count : counts) count = random() % 3 == 0 ? 0 : uint64_t{1} << random() % 30;
    const auto trained = HuffmanCode::fromCounts(counts);
    const auto code = throughTheWire(trained);
    BitWriter out;
    std::vector<size_t> symbols;
    for (size_t s = 0; s < counts.size(); ++s) {
      EXPECT_EQ(code.has(s), counts[s] > 0);
      if (counts[s] > 0) symbols.push_back(s);
    }
    for (const size_t s : symbols) trained.write(out, s);
    const Bytes bytes = out.take();
    BitReader in(bytes);
    for (const size_t s : symbols) ASSERT_EQ(code.read(in), s);
    EXPECT_FALSE(in.overrun());
  }
}

TEST(HuffmanCode, LimitsLengths) {
  std::vector<uint64_t> fibonacci{1, 1};
  while (fibonacci.size() < 40)
    fibonacci.push_back(fibonacci[fibonacci.size() - 1] + fibonacci[fibonacci.size() - 2]);
  const auto code = HuffmanCode::fromCounts(fibonacci);
  double kraft = 0;
  for (size_t s = 0; s < fibonacci.size(); ++s) {
    EXPECT_LE(code.length(s), kMaxHuffmanLength);
    kraft += std::pow(0.5, code.length(s));
  }
  EXPECT_EQ(kraft, 1.0);
}

TEST(HuffmanCode, OneSymbolTakesNoBits) {
  const auto code = throughTheWire(HuffmanCode::fromCounts(std::vector<uint64_t>{0, 0, 9}));
  const Bytes nothing;
  BitReader in(nothing);
  EXPECT_EQ(code.read(in), 2U);
  EXPECT_FALSE(in.overrun());
}

TEST(HuffmanCode, WithoutSymbolsFailsTheReader) {
  const auto code = throughTheWire(HuffmanCode::fromCounts(std::vector<uint64_t>{0, 0}));
  const Bytes bytes(10, 0);
  BitReader in(bytes);
  EXPECT_EQ(code.read(in), 0U);
  EXPECT_TRUE(in.overrun());
  BitReader other(bytes);
  EXPECT_EQ(HuffmanCode().read(other), 0U);
  EXPECT_TRUE(other.overrun());
}

TEST(HuffmanCode, SurvivesAnyBytes) {
  std::mt19937_64 random(4);
  size_t accepted = 0;
  for (int round = 0; round < 20000; ++round) {
    Bytes bytes(1 + random() % 24);
    for (auto& byte : bytes) byte = static_cast<uint8_t>(random() & random());
    BitReader in(bytes);
    const auto code = HuffmanCode::readFrom(in, 1 + random() % 64);
    if (in.overrun()) continue;
    ++accepted;
    for (int i = 0; i < 8; ++i) EXPECT_LT(code.read(in), 64U);
  }
  EXPECT_GT(accepted, 0U);
}

}  // namespace
}  // namespace meshfront
