#include "shared/receiver/ranking.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/data/mesh_shapes.h"
#include "tests/unit/encoded_mesh.h"

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

TEST(Ranking, LeavesOutWhatIsKeptIfToldTo) {
  const RecordsAtHand records(encodedContent(torus(30, 20)));
  auto mesh = SelectivelyRefinedMesh::fromBase(records.base()).value();
  const std::vector<uint32_t> pixels(mesh.vertexSlotCount(), 9);
  const size_t all = allCandidates(mesh, {}).size();
  ASSERT_EQ(visibleCandidates(mesh, pixels, {}).size(), all);
  NodeIndex root = 0;
  while (mesh.isLeaf(root)) ++root;
  ASSERT_TRUE(records.split(mesh, root));
  mesh.collapse(root);
  const auto asksFor = [root](const std::vector<Candidate>& candidates) {
    return std::any_of(candidates.begin(), candidates.end(),
                       [root](const Candidate& c) { return c.node == root; });
  };
  EXPECT_TRUE(asksFor(visibleCandidates(mesh, pixels, {})));
  const RankingBias withoutKept{.withoutKept = true};
  EXPECT_EQ(visibleCandidates(mesh, pixels, {}, withoutKept).size(), all - 1);
  EXPECT_FALSE(asksFor(visibleCandidates(mesh, pixels, {}, withoutKept)));
  ASSERT_TRUE(mesh.dropRecord(root));
  EXPECT_TRUE(asksFor(visibleCandidates(mesh, pixels, {}, withoutKept)));
}

}  // namespace
}  // namespace meshfront
