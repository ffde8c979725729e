#include "shared/codec/cut_coding.h"

#include <gtest/gtest.h>

#include <random>

#include "shared/codec/ring_cut.h"

namespace meshfront {
namespace {

// Five roots around the origin of a plane, counter-clockwise; d points along x.
const std::vector<GridPosition> kAround{
    {120, 100, 50}, {105, 120, 50}, {82, 110, 50}, {85, 90, 50}, {108, 80, 50}};
const GridPosition kCentre{100, 100, 50};
const GridPosition kDelta{16, 0, 0};
const PredictedNormal kUp{0, 0, kNormalLength};

std::vector<NodeId> rootEntries(size_t count) {
  std::vector<NodeId> entries;
  for (uint32_t i = 0; i < count; ++i) entries.push_back(NodeId::root(i));
  return entries;
}

template <typename Coder>
RingCut walkRoots(Coder& coder, RingCut target) {
  const auto entries = rootEntries(kAround.size());
  // Gap 3 is the smallest: run 0 begins at entry 4.
  return walkRing(
      std::span<const NodeId>(entries),
      [](uint32_t gap) { return FaceKey::ofBase(gap == 3 ? 0 : gap + 1); },
      [](uint32_t entry, unsigned depth) -> std::optional<GridPosition> {
        EXPECT_EQ(depth, 0U);
        return kAround[entry];
      },
      CutFrame(kCentre, kDelta, kUp), coder, target);
}

TEST(CutCoding, HasLiteralDecisionsForFiveRuns) {
  std::vector<CutDecision> cut;
  CutRecorder recorder(cut);
  const RingCut target{1, 4, false};
  walkRoots(recorder, target);
  // Entry 1 is run 2, entry 4 run 0: symbol 2 * 5 + 0 of 30, 01010 in the tree of five runs.
  ASSERT_EQ(cut.size(), 5U);
  const std::vector<unsigned> nodes{1, 2, 5, 10, 21};
  const std::vector<bool> bits{false, true, false, true, false};
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(cut[i].context, cyclicContexts(5, 0) + nodes[i]);
    EXPECT_EQ(cut[i].bit, bits[i]);
    EXPECT_FALSE(cut[i].backward);
  }
  TwoEndedWriter writer;
  writeCut(writer, cut, evenCutChances());
  const auto region = writer.ofLength(writer.shortestLength());
  EXPECT_EQ(*region, (std::vector<bool>{false, true, false, true}));  // the last 0 is implied

  CodeTables tables;
  const std::vector<uint8_t> bytes{0b01010000};
  CutDecoder decoder(tables, bytes, 0, 4);
  const RingCut back = walkRoots(decoder, {});
  EXPECT_EQ(back.left, 1U);
  EXPECT_EQ(back.right, 4U);
}

TEST(CutCoding, CodesEverySymbolOfEveryCount) {
  CodeTables tables;
  for (uint32_t count = 2; count <= 42; ++count) {
    for (uint32_t symbol = 0; symbol < count; ++symbol) {
      std::vector<CutDecision> cut;
      CutRecorder recorder(cut);
      ASSERT_EQ(codeSymbol(recorder, 0, count, symbol), symbol);
      for (const auto& decision : cut) EXPECT_LT(decision.context, std::bit_ceil(count));
      TwoEndedWriter writer;
      writeCut(writer, cut, tables.cutChances);
      const auto region = writer.ofLength(8);
      BitWriter out;
      for (const bool bit : *region) out.writeBit(bit);
      const auto bytes = out.take();
      CutDecoder decoder(tables, bytes, 0, 8);
      EXPECT_EQ(codeSymbol(decoder, 0, count, 0), symbol) << count;
    }
  }
}

TEST(CutCoding, GivesEveryContextItsOwnNumber) {
  EXPECT_EQ(cyclicContexts(2, 0), 0U);
  EXPECT_EQ(cyclicContexts(3, 0), 16U * 8);
  EXPECT_EQ(linearContexts(2, false, 0), cyclicContexts(6, 0) + 64);
  EXPECT_EQ(linearContexts(6, true, 0) + 32, stepContext(0));
  EXPECT_EQ(stepContext(kStepPlaces), kEvenContext);
  EXPECT_EQ(kCutContexts, 803U);  // as the format's description says
}

TEST(CutStatistics, TrainsChancesThatServeTheCounts) {
  CutStatistics statistics;
  statistics.counts[7] = {48000, 16000};
  statistics.counts[9] = {0, 5000};
  statistics.counts[11] = {1, 0};  // not worth its place in the tables
  const CutChances chances = statistics.chances();
  EXPECT_EQ(chances[0], kEvenChance);
  EXPECT_EQ(chances[7], 48);
  EXPECT_EQ(chances[8], 48);
  EXPECT_EQ(chances[9], 1);
  EXPECT_EQ(chances[11], 1);
  EXPECT_EQ(chances[kEvenContext], kEvenChance);
}

TEST(CutFrame, TellsSidesAndWhichTriangleIsBetter) {
  const CutFrame frame(kCentre, kDelta, kUp);
  const auto at = [&](int x, int y) { return frame.place(GridPosition{100 + x, 100 + y, 50}); };
  EXPECT_EQ(frame.pairPlaces(at(20, 5), at(-3, -8)), 0b1010U);
  EXPECT_EQ(frame.pairPlaces(at(8, 0), at(9, 1)), 0b0101U);  // not beyond the middle; beyond
  EXPECT_FALSE(frame.place(std::optional<GridPosition>()).known);
  EXPECT_EQ(frame.stepPlaces({}, at(1, 1), false), 258U);
  EXPECT_EQ(frame.stepPlaces(at(1, 1), {}, true), 257U);
  EXPECT_EQ(frame.stepPlaces({}, {}, true), 256U);
  // The corners of a square stand on one circle: neither diagonal is better.
  const unsigned square = frame.stepPlaces(at(16, 16), at(0, 16), false);
  EXPECT_EQ(square / 64, 3U);
  EXPECT_EQ(square % 16, 7U);
  // A near node right above the middle beats a far one behind s, and the other way about.
  const unsigned near = frame.stepPlaces(at(8, 14), at(-20, 10), false);
  EXPECT_GT(near % 16, 8U);
  const unsigned far = frame.stepPlaces(at(36, 10), at(8, 14), false);
  EXPECT_LT(far % 16, 7U);
  // r's side is l's in the mirror.
  EXPECT_EQ(frame.stepPlaces(at(8, -14), at(-20, -10), true), near);
  EXPECT_EQ(frame.stepPlaces(at(36, -10), at(8, -14), true), far);
}

TEST(CutFrame, StandsTheLargestGridAndNoDirection) {
  constexpr int32_t kFar = (1 << kMaxQuantizationBits) - 1;
  std::mt19937 random(3);
  const auto anywhere = [&] {
    GridPosition p{};
    for (auto& x : p)
      x = random() % 3 == 0 ? static_cast<int32_t>(random() % 2) * kFar
                            : static_cast<int32_t>(random() % (kFar + 1));
    return p;
  };
  for (int i = 0; i < 20000; ++i) {
    const GridPosition s = anywhere();
    const GridPosition t = i % 10 == 0 ? s : anywhere();
    const PredictedNormal normal{static_cast<int16_t>(static_cast<int>(random() % 32767) - 16383),
                                 -16384, 16384};
    const CutFrame frame(s, {t[0] - s[0], t[1] - s[1], t[2] - s[2]}, normal);
    const auto a = frame.place(anywhere());
    const auto b = frame.place(anywhere());
    EXPECT_LT(frame.stepPlaces(a, b, i % 2 == 0), 256U);
    EXPECT_LT(frame.pairPlaces(a, b), kPairPlaces);
  }
}

}  // namespace
}  // namespace meshfront
