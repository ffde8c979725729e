#include "proxy/fetch_memory.h"

#include <gtest/gtest.h>

namespace meshfront {
namespace {

TEST(FetchMemory, IsGivenBack) {
  FetchMemory memory(1'000'000);
  {
    FetchMemory::Share share = memory.share();
    EXPECT_TRUE(share.take(400'000));
    EXPECT_GE(share.left(), 600'000U);
    FetchMemory::Share other = memory.share();
    EXPECT_FALSE(other.take(700'000));
    EXPECT_TRUE(other.take(500'000));
    const FetchMemory::Share moved = std::move(other);
    EXPECT_GE(memory.bytes(), 900'000U);
    EXPECT_LE(memory.bytes(), memory.limit());
    EXPECT_FALSE(share.take(200'000));
    EXPECT_TRUE(share.take(100'000));
  }
  EXPECT_EQ(memory.bytes(), 0U);
}

TEST(FetchMemory, SmallTakesAddUp) {
  FetchMemory memory(200'000);
  FetchMemory::Share share = memory.share();
  size_t taken = 0;
  while (share.take(100)) taken += 100;
  EXPECT_EQ(taken, 200'000U);
}

TEST(FetchMemory, AnEmptyShareRefusesNothing) {
  FetchMemory::Share share;
  EXPECT_TRUE(share.take(size_t{1} << 60));
}

}  // namespace
}  // namespace meshfront
