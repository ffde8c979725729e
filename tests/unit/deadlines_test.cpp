#include "shared/http/server/deadlines.h"

#include <gtest/gtest.h>

namespace meshfront {
namespace {

TEST(Deadlines, PassInTheOrderTheyWereSetIn) {
  DeadlineList list(10);
  int owners[3] = {};
  Deadline first(&owners[0]);
  Deadline second(&owners[1]);
  EXPECT_EQ(list.next(), INT64_MAX);
  list.set(first, 100);
  list.set(second, 105);
  EXPECT_EQ(list.next(), 110);
  EXPECT_EQ(list.passed(109), nullptr);
  EXPECT_EQ(list.passed(110)->owner(), &owners[0]);
  EXPECT_EQ(list.passed(110), nullptr);
  list.set(first, 106);
  list.set(second, 107);  // anew
  EXPECT_EQ(list.passed(200), &first);
  EXPECT_EQ(list.passed(200), &second);
  EXPECT_EQ(list.passed(200), nullptr);
}

TEST(Deadlines, AreLeftAndChanged) {
  DeadlineList list(10);
  DeadlineList other(1000);
  Deadline kept(nullptr);
  {
    Deadline gone(nullptr);
    Deadline cleared(nullptr);
    list.set(gone, 0);
    list.set(cleared, 0);
    list.set(kept, 0);
    cleared.clear();
    cleared.clear();
  }
  EXPECT_EQ(list.next(), 10);
  other.set(kept, 0);
  EXPECT_EQ(list.next(), INT64_MAX);
  EXPECT_EQ(other.next(), 1000);
}

}  // namespace
}  // namespace meshfront
