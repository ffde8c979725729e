// Both ways to hold a ring's partings answer alike.
#include "shared/codec/ring_partings.h"

#include <gtest/gtest.h>

#include <random>

namespace meshfront {
namespace {

#ifdef __SSE2__

// Leaves of small trees in ring order, such that neighbours differ and none is above another one.
std::vector<NodeId> randomRing(std::mt19937& random, size_t size) {
  std::vector<NodeId> ring;
  while (ring.size() < size) {
    const NodeId id{static_cast<uint32_t>(random() % 3), 6,
                    static_cast<uint64_t>(random() % 64) << 58};
    const bool last = ring.size() + 1 == size;
    if ((!ring.empty() && ring.back() == id) || (last && ring.front() == id)) continue;
    ring.push_back(id);
  }
  return ring;
}

std::vector<uint32_t> runStarts(const auto& partings, uint32_t runs) {
  std::vector<uint32_t> starts;
  for (uint32_t i = 0; i < runs; ++i) starts.push_back(partings.run(i).begin);
  starts.push_back(partings.run(runs - 1).end);
  return starts;
}

TEST(RingPartings, AreTheSameInARegister) {
  std::mt19937 random(7);
  for (size_t round = 0; round < 4000; ++round) {
    const auto size = static_cast<uint32_t>(2 + random() % (NarrowPartings::kMost - 1));
    const std::vector<NodeId> ring = randomRing(random, size);
    NarrowPartings narrow(ring);
    WidePartings wide(ring);
    ASSERT_EQ(narrow.earliest(), wide.earliest());
    std::vector<uint32_t> narrowGaps;
    std::vector<uint32_t> wideGaps;
    narrow.forEachGap(wide.earliest(), [&](uint32_t gap) { narrowGaps.push_back(gap); });
    wide.forEachGap(wide.earliest(), [&](uint32_t gap) { wideGaps.push_back(gap); });
    ASSERT_EQ(narrowGaps, wideGaps);
    const auto origin = static_cast<uint32_t>(random() % size);
    narrow.startAt(origin);
    wide.startAt(origin);
    for (uint32_t begin = 0; begin < size; ++begin)
      for (uint32_t end = begin + 2; end <= size; ++end) {
        const uint32_t depth = wide.earliestIn({begin, end});
        ASSERT_EQ(narrow.earliestIn({begin, end}), depth);
        const uint32_t runs = wide.cut({begin, end}, depth);
        ASSERT_EQ(narrow.cut({begin, end}, depth), runs);
        ASSERT_EQ(runStarts(narrow, runs), runStarts(wide, runs));
      }
  }
}

TEST(RingPartings, AreLiteral) {
  // Two nodes of tree 0 that part at depth 2, one of tree 1.
  const std::vector<NodeId> ring{
      {0, 3, uint64_t{0b010} << 61}, {0, 3, uint64_t{0b011} << 61}, {1, 0, 0}};
  NarrowPartings partings(ring);
  EXPECT_EQ(partings.earliest(), 0U);
  EXPECT_EQ(partings.earliestIn({0, 2}), 3U);
  EXPECT_EQ(partings.cut({0, 3}, 0), 2U);
  EXPECT_EQ(partings.run(0).end, 2U);
  EXPECT_TRUE(partings.run(1).single());
}

#endif

}  // namespace
}  // namespace meshfront
