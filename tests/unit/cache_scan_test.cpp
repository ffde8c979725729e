// One client's download of everything does not flush what many share.
#include "tests/data/cache_scan.h"

#include <gtest/gtest.h>

namespace meshfront {
namespace {

TEST(CacheScan, LeavesTheReceiversHits) {
  ScanPlan plan;
  plan.coarse = 1'000;
  plan.views = 40;
  plan.perView = 500;
  plan.others = 60'000;
  plan.capacity = 8'000;
  plan.receivers = 150;
  plan.pace = 10;
  const ScanRatios proxy = simulateScan<ProxyRecords>(plan);
  const ScanRatios lru = simulateScan<LruRecords>(plan);
  EXPECT_GT(proxy.before, lru.before - 0.03);
  EXPECT_GT(proxy.during, proxy.before - 0.05);
  EXPECT_GT(proxy.after, proxy.before - 0.03);
  EXPECT_LT(lru.during, proxy.during - 0.2);  // or this test shows nothing
}

}  // namespace
}  // namespace meshfront
