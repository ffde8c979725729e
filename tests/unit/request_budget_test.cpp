#include "shared/receiver/request_budget.h"

#include <gtest/gtest.h>

#include "shared/receiver/retry_schedule.h"

namespace meshfront {
namespace {

using std::chrono::milliseconds;

TEST(RequestBudget, IsUnboundedWithoutLimits) {
  EXPECT_FALSE(RequestBudget().limited());
  EXPECT_EQ(RequestBudget().recordsAllowed(1'000, 1'000, 50, 2), UINT64_MAX);
}

TEST(RequestBudget, CountsRecordsExactly) {
  const RequestBudget budget({.records = 500, .bytesDown = {}});
  EXPECT_TRUE(budget.limited());
  EXPECT_EQ(budget.recordsAllowed(0, 0, 0, 0), 500U);
  EXPECT_EQ(budget.recordsAllowed(300, 0, 150, 1), 50U);
  EXPECT_EQ(budget.recordsAllowed(300, 0, 200, 1), 0U);
  EXPECT_EQ(budget.recordsAllowed(300, 0, 900, 1), 0U);
}

TEST(RequestBudget, LearnsWhatARecordTakes) {
  RequestBudget budget({.records = {}, .bytesDown = 10'000});
  budget.observeAnswer(100, 4'000, 1'000);  // 4 bytes each
  const uint64_t allowed = budget.recordsAllowed(1'000, 4'100, 0, 0);
  EXPECT_LE(allowed * 4 + 100, 10'000U - 4'100U);
  EXPECT_GE(allowed * 4 + 100, (10'000U - 4'100U) * 9 / 10);
  // What is under way is set aside, with its headers.
  EXPECT_LT(budget.recordsAllowed(1'000, 4'100, 700, 1), allowed - 700);
  EXPECT_EQ(budget.recordsAllowed(1'000, 9'901, 0, 0), 0U);
  EXPECT_EQ(budget.recordsAllowed(1'000, 20'000, 0, 0), 0U);
}

TEST(AdaptiveBatch, GrowsWithTheMesh) {
  EXPECT_EQ(adaptiveBatch(0), kSmallestAdaptiveBatch);
  EXPECT_EQ(adaptiveBatch(4'000), 1'000U);
  EXPECT_EQ(adaptiveBatch(1'000'000), kLargestAdaptiveBatch);
}

TEST(RetrySchedule, DoublesWithJitterUpToItsBound) {
  RetrySchedule schedule({4, milliseconds(100), milliseconds(350)}, 3);
  EXPECT_TRUE(schedule.mayRetry(1));
  EXPECT_TRUE(schedule.mayRetry(3));
  EXPECT_FALSE(schedule.mayRetry(4));
  bool differs = false;
  for (int i = 0; i < 50; ++i) {
    const milliseconds first = schedule.delay(1, milliseconds(0));
    EXPECT_GE(first, milliseconds(50));
    EXPECT_LE(first, milliseconds(100));
    differs = differs || first != schedule.delay(1, milliseconds(0));
    const milliseconds second = schedule.delay(2, milliseconds(0));
    EXPECT_GE(second, milliseconds(100));
    EXPECT_LE(second, milliseconds(200));
    EXPECT_LE(schedule.delay(60, milliseconds(0)), milliseconds(350));
  }
  EXPECT_TRUE(differs);
}

TEST(RetrySchedule, HeedsTheServerWithinReason) {
  RetrySchedule schedule({4, milliseconds(100), milliseconds(2'000)}, 3);
  EXPECT_EQ(schedule.delay(1, milliseconds(1'500)), milliseconds(1'500));
  EXPECT_EQ(schedule.delay(1, std::chrono::hours(1)), milliseconds(2'000));
}

}  // namespace
}  // namespace meshfront
