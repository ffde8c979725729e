#include <gtest/gtest.h>

#include <random>
#include <string_view>

#include "shared/bits/base64url.h"
#include "shared/bits/bit_reader.h"
#include "shared/bits/bit_store.h"
#include "shared/bits/bit_writer.h"
#include "shared/bits/crc32c.h"
#include "shared/bits/integer_codes.h"

namespace meshfront {
namespace {

using Bytes = std::vector<uint8_t>;

TEST(BitWriter, WritesMostSignificantBitFirst) {
  BitWriter out;
  out.write(0b101, 3);
  out.write(0, 0);
  out.write(0xFFFF, 4);  // only the low four
  out.write(0x123456789ABCDE, 57);
  EXPECT_EQ(out.bitCount(), 64U);
  EXPECT_EQ(out.padded(), (Bytes{0b10111110, 0x12, 0x34, 0x56, 0x78, 0x9A, 0xBC, 0xDE}));
  EXPECT_EQ(out.take().size(), 8U);
  EXPECT_EQ(out.bitCount(), 0U);
}

TEST(BitReader, ReadsBackWhatWasWrittenAtAnyAlignment) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 200; ++round) {
    std::vector<std::pair<uint64_t, unsigned>> values;
    BitWriter out;
    for (int i = 0; i < 100; ++i) {
      const auto width = static_cast<unsigned>(random() % 58);
      const uint64_t value = width == 0 ? 0 : random() >> (64 - width);
      values.emplace_back(value, width);
      out.write(value, width);
    }
    const uint64_t bits = out.bitCount();
    const Bytes bytes = out.take();
    BitReader in(bytes, 0, bits);
    for (const auto& [value, width] : values) ASSERT_EQ(in.read(width), value);
    EXPECT_FALSE(in.overrun());
    EXPECT_EQ(in.left(), 0U);
  }
}

TEST(BitReader, GivesZerosAndRemembersPastTheEnd) {
  const Bytes bytes{0xFF, 0xFF};
  BitReader in(bytes, 3, 13);
  EXPECT_EQ(in.peek(12), 0b111111111100U);
  EXPECT_EQ(in.read(10), 0x3FFU);
  EXPECT_FALSE(in.overrun());
  EXPECT_EQ(in.read(1), 0U);
  EXPECT_TRUE(in.overrun());
  EXPECT_EQ(in.read(57), 0U);
  BitReader outside(bytes, 99, 200);
  EXPECT_TRUE(outside.overrun());
}

TEST(BitWriter, AppendsBitRanges) {
  std::mt19937_64 random(2);
  Bytes source(64);
  for (auto& byte : source) byte = static_cast<uint8_t>(random());
  for (int round = 0; round < 300; ++round) {
    const uint64_t begin = random() % 200;
    const uint64_t count = random() % 300;
    BitWriter out;
    BitStore store;
    const auto lead = static_cast<unsigned>(random() % 9);
    out.write(0, lead);
    store.append(Bytes{0, 0}, 0, lead);
    out.append(source, begin, count);
    store.append(source, begin, count);
    const Bytes bytes = out.take();
    EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), store.bytes().begin(), store.bytes().end()));
    BitReader got(bytes, lead, lead + count);
    BitReader want(source, begin, begin + count);
    for (uint64_t i = 0; i < count; ++i) ASSERT_EQ(got.readBit(), want.readBit());
  }
}

TEST(ExpGolomb, HasTheStandardCodes) {
  BitWriter out;
  for (const uint64_t value : {0, 1, 2, 3}) writeExpGolomb(out, value, 0);  // 1 010 011 00100
  EXPECT_EQ(out.bitCount(), 12U);
  EXPECT_EQ(out.take(), (Bytes{0b10100110, 0b01000000}));
  for (unsigned order = 0; order < 17; ++order) {
    for (const uint64_t value :
         {uint64_t{0}, uint64_t{7}, uint64_t{100000}, uint64_t{UINT32_MAX}}) {
      writeExpGolomb(out, value, order);
      const Bytes bytes = out.take();
      BitReader in(bytes);
      EXPECT_EQ(readExpGolomb(in, order), value);
      EXPECT_FALSE(in.overrun());
    }
  }
}

TEST(ExpGolomb, RefusesEndlessPrefixes) {
  const Bytes zeros(100, 0);
  BitReader in(zeros);
  EXPECT_EQ(readExpGolomb(in, 0), 0U);
  EXPECT_TRUE(in.overrun());
  const Bytes nothing;
  BitReader empty(nothing);
  EXPECT_EQ(readExpGolomb(empty, 3), 0U);
  EXPECT_TRUE(empty.overrun());
}

TEST(TruncatedBinary, TakesFloorOrCeilOfLog2) {
  for (uint32_t n = 1; n <= 70; ++n) {
    uint64_t kraft = 0;
    for (uint32_t value = 0; value < n; ++value) {
      BitWriter out;
      writeTruncated(out, value, n);
      kraft += uint64_t{1} << (16 - out.bitCount());
      const Bytes bytes = out.take();
      BitReader in(bytes);
      EXPECT_EQ(readTruncated(in, n), value);
    }
    EXPECT_EQ(kraft, 1U << 16);  // no code is wasted
  }
}

TEST(Crc32c, MatchesTheKnownVectors) {
  const std::string_view digits = "123456789";
  const Bytes bytes(digits.begin(), digits.end());
  EXPECT_EQ(crc32c(bytes), 0xE3069283U);
  EXPECT_EQ(crc32c(Bytes(32, 0)), 0x8A9136AAU);  // RFC 3720 B.4
  EXPECT_EQ(crc32c(std::span(bytes).subspan(4), crc32c(std::span(bytes).first(4))), 0xE3069283U);
}

TEST(Crc32c, ChecksContent) {
  Bytes bytes{1, 2, 3};
  appendChecksum(bytes);
  ASSERT_TRUE(checkedContent(bytes, "it"));
  EXPECT_EQ(checkedContent(bytes, "it")->size(), 3U);
  for (size_t bit = 0; bit < bytes.size() * 8; ++bit) {
    Bytes damaged = bytes;
    damaged[bit / 8] ^= static_cast<uint8_t>(1U << bit % 8);
    EXPECT_FALSE(checkedContent(damaged, "it"));
  }
  for (size_t length = 0; length < bytes.size(); ++length)
    EXPECT_FALSE(checkedContent(std::span(bytes).first(length), "it"));
}

TEST(Base64url, HasOneSpellingEach) {
  EXPECT_EQ(base64urlEncode(Bytes{}), "");
  EXPECT_EQ(base64urlEncode(Bytes{0xFB, 0xFF}), "-_8");
  EXPECT_EQ(base64urlEncode(Bytes{'f', 'o', 'o'}), "Zm9v");
  EXPECT_EQ(base64urlDecode("-_8").value(), (Bytes{0xFB, 0xFF}));
  EXPECT_EQ(base64urlDecode("Zg").value(), Bytes{'f'});
  EXPECT_FALSE(base64urlDecode("Zh"));    // spare bits set
  EXPECT_FALSE(base64urlDecode("Zg=="));  // padded
  EXPECT_FALSE(base64urlDecode("Z"));
  EXPECT_FALSE(base64urlDecode("Zm9v+w"));
  EXPECT_FALSE(base64urlDecode("Zm 9v"));
}

}  // namespace
}  // namespace meshfront
