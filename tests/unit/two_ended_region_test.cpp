#include "shared/bits/two_ended_region.h"

#include <gtest/gtest.h>

#include <random>

namespace meshfront {
namespace {

struct Decision {
  bool bit;
  unsigned chance;
};
using Decisions = std::vector<Decision>;

std::string text(const TwoEndedWriter::Region& region) {
  std::string out;
  for (const bool bit : region) out += bit ? '1' : '0';
  return out;
}

TwoEndedWriter written(const Decisions& forward, const Decisions& backward) {
  TwoEndedWriter out;
  for (const auto& d : forward) out.forward().encode(d.bit, d.chance);
  for (const auto& d : backward) out.backward().encode(d.bit, d.chance);
  return out;
}

std::string shortest(const Decisions& forward, const Decisions& backward) {
  const auto out = written(forward, backward);
  return text(*out.ofLength(out.shortestLength()));
}

// Puts the region behind `offset` one-bits and before as many, reads both directions in turn.
void expectDecodes(const TwoEndedWriter::Region& region, const Decisions& forward,
                   const Decisions& backward, unsigned offset) {
  BitWriter out;
  for (unsigned i = 0; i < offset; ++i) out.writeBit(true);
  for (const bool bit : region) out.writeBit(bit);
  for (unsigned i = 0; i < offset; ++i) out.writeBit(true);
  const auto bytes = out.take();
  TwoEndedReader in(bytes, offset, offset + region.size());
  for (size_t i = 0; i < std::max(forward.size(), backward.size()); ++i) {
    if (i < backward.size()) {
      ASSERT_EQ(in.backward(backward[i].chance), backward[i].bit) << i;
    }
    if (i < forward.size()) {
      ASSERT_EQ(in.forward(forward[i].chance), forward[i].bit) << i;
    }
  }
}

TEST(TwoEndedRegion, HasLiteralBits) {
  const Decision zero{false, kEvenChance};
  const Decision one{true, kEvenChance};
  EXPECT_EQ(shortest({}, {}), "0");
  EXPECT_EQ(shortest({zero, zero, zero}, {}), "0");  // what follows the end is zero
  EXPECT_EQ(shortest({one}, {}), "1");
  EXPECT_EQ(shortest({}, {one}), "1");
  EXPECT_EQ(shortest({one}, {one}), "1");  // one bit says both
  EXPECT_EQ(shortest({one}, {zero}), "10");
  EXPECT_EQ(shortest({one, zero, one}, {}), "101");
  EXPECT_EQ(shortest({}, {one, zero, one, one}), "1101");
  EXPECT_EQ(shortest({one, one, zero}, {one, one}), "11");
  EXPECT_EQ(shortest({one, one, zero, one}, {zero, one, one}), "110110");
  // 16 of 64 for a zero: ones take less than a bit, [0.25, 1) and [0.4375, 1).
  EXPECT_EQ(shortest({{true, 16}, {true, 16}}, {}), "1");
  EXPECT_EQ(shortest({{false, 16}, {true, kEvenChance}}, {}), "001");
}

TEST(TwoEndedRegion, KeepsDecisionsApartAtEveryLength) {
  std::mt19937_64 random(5);
  const auto some = [&](size_t most) {
    Decisions out(random() % (most + 1));
    for (auto& d : out) {
      d.chance = 1 + static_cast<unsigned>(random() % 63);
      d.bit = random() % 64 >= d.chance;
    }
    return out;
  };
  for (int round = 0; round < 3000; ++round) {
    const Decisions forward = some(12);
    const Decisions backward = some(12);
    const auto out = written(forward, backward);
    const unsigned safe = out.safeLength();
    const unsigned least = out.shortestLength();
    ASSERT_LE(least, safe);
    for (unsigned length = 1; length < safe + 12; ++length) {
      const auto region = out.ofLength(length);
      if (length < least) {
        ASSERT_FALSE(region) << length;
      }
      if (length == least || length >= safe) {
        ASSERT_TRUE(region) << length;
      }
      if (!region) continue;
      ASSERT_EQ(region->size(), length);
      expectDecodes(*region, forward, backward, round % 17);
    }
  }
}

TEST(TwoEndedRegion, HoldsManyDecisionsAndCarries) {
  std::mt19937_64 random(6);
  for (const unsigned chance : {1U, 2U, 31U, 62U, 63U}) {
    for (const bool likely : {false, true}) {
      Decisions forward;
      Decisions backward;
      for (int i = 0; i < 3000; ++i) {
        // Long runs of ones drive the interval's begin to its top, where carries run far.
        const bool bit = likely ? random() % 64 >= chance : i % 7 != 0;
        forward.push_back({bit, chance});
        backward.push_back({!bit, 64 - chance});
      }
      const auto out = written(forward, backward);
      EXPECT_EQ(out.shortestLength(), out.safeLength());
      expectDecodes(*out.ofLength(out.safeLength() + 3), forward, backward, 3);
    }
  }
}

TEST(TwoEndedRegion, NeedsAboutWhatTheDecisionsTell) {
  std::mt19937_64 random(7);
  double told = 0;
  double bits = 0;
  for (int round = 0; round < 2000; ++round) {
    Decisions forward(6);
    Decisions backward(6);
    for (auto* decisions : {&forward, &backward})
      for (auto& d : *decisions) {
        d.chance = 50;
        d.bit = random() % 64 >= d.chance;
        told += -std::log2((d.bit ? 64 - d.chance : d.chance) / 64.0);
      }
    bits += written(forward, backward).shortestLength();
  }
  EXPECT_LT(bits, told);  // a length tells something too, and zeros behind the end are free
  EXPECT_GT(bits, told / 2);
}

TEST(TwoEndedRegion, ReadsAnythingWithoutLeavingIt) {
  std::mt19937_64 random(8);
  for (int round = 0; round < 2000; ++round) {
    std::vector<uint8_t> bytes(random() % 12);
    for (auto& byte : bytes) byte = static_cast<uint8_t>(random());
    const uint64_t end = bytes.empty() ? 0 : random() % (bytes.size() * 8 + 1);
    const uint64_t begin = end == 0 ? 0 : random() % (end + 1);
    TwoEndedReader in(bytes, begin, end);
    for (int i = 0; i < 300; ++i) {
      in.forward(1 + static_cast<unsigned>(random() % 63));
      in.backward(1 + static_cast<unsigned>(random() % 63));
    }
  }
}

}  // namespace
}  // namespace meshfront
