#include "shared/receiver/ranking.h"

#include <gtest/gtest.h>

#include <random>

namespace meshfront {
namespace {

std::vector<VertexSlot> slotsOf(const std::vector<Candidate>& candidates) {
  std::vector<VertexSlot> slots;
  slots.reserve(candidates.size());
  for (const Candidate& candidate : candidates) slots.push_back(candidate.slot);
  return slots;
}

// node, slot, pixels, level
const std::vector<Candidate> kFew = {{10, 0, 5, 3}, {11, 1, 900, 4}, {12, 2, 7, 3},
                                     {13, 3, 7, 3}, {14, 4, 1, 2},   {15, 5, 900, 5}};

TEST(Ranking, TiesFallToTheFirstInPreorder) {
  const NodeId first = NodeId::root(3).child(false);
  const NodeId second = NodeId::root(3).child(true);
  const Candidate a{7, 9, 5, 2, first};
  const Candidate b{8, 1, 5, 2, second};
  for (const RankOrder order : {RankOrder::significance, RankOrder::pixels}) {
    EXPECT_TRUE(ranksBefore(order, a, b));
    EXPECT_FALSE(ranksBefore(order, b, a));
  }
}

TEST(Ranking, SignificancePutsTheLevelBeforeThePixels) {
  auto candidates = kFew;
  keepFirst(candidates, 100, RankOrder::significance);
  EXPECT_EQ(slotsOf(candidates), (std::vector<VertexSlot>{4, 2, 3, 0, 1, 5}));
}

TEST(Ranking, PixelsAloneIsThePublishedOrder) {
  auto candidates = kFew;
  keepFirst(candidates, 100, RankOrder::pixels);
  EXPECT_EQ(slotsOf(candidates), (std::vector<VertexSlot>{1, 5, 2, 3, 0, 4}));
}

TEST(Ranking, KeepsTheFirstOnesWhateverTheInputsOrder) {
  std::mt19937 random(7);
  std::vector<Candidate> many;
  for (uint32_t i = 0; i < 5'000; ++i)
    many.push_back(
        {i, i, static_cast<uint32_t>(random() % 40), static_cast<uint8_t>(random() % 9)});
  for (const RankOrder order : {RankOrder::significance, RankOrder::pixels}) {
    auto sorted = many;
    keepFirst(sorted, sorted.size(), order);
    for (const size_t count : {size_t{0}, size_t{1}, size_t{313}, size_t{4'999}}) {
      auto shuffled = many;
      std::shuffle(shuffled.begin(), shuffled.end(), random);
      keepFirst(shuffled, count, order);
      auto expected = slotsOf(sorted);
      expected.resize(count);
      EXPECT_EQ(slotsOf(shuffled), expected) << count;
    }
  }
}

}  // namespace
}  // namespace meshfront
