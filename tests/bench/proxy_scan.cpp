// proxy-scan: prints what a full download of a pack does to the receivers' hit ratio, with the
// proxy's cache and with plain LRU of as many records, for scans from slow to fast and for caches
// from small to large.
#include <cstdio>

#include "tests/data/cache_scan.h"

namespace {

using namespace meshfront;

void print(const char* policy, const ScanPlan& plan, const ScanRatios& ratios) {
  std::printf("%-6s %8u %8u %5u   %6.1f %% %6.1f %% %6.1f %%\n", policy, plan.packRecords(),
              plan.capacity, plan.pace, 100 * ratios.before, 100 * ratios.during,
              100 * ratios.after);
}

}  // namespace

int main() {
  std::printf("policy     pack    cache  pace     before   during    after the scan\n");
  for (const uint32_t capacity : {20'000U, 60'000U, 150'000U})
    for (const unsigned pace : {1U, 4U, 20U}) {
      ScanPlan plan;
      plan.capacity = capacity;
      plan.pace = pace;
      print("LRU", plan, simulateScan<LruRecords>(plan));
      print("proxy", plan, simulateScan<ProxyRecords>(plan));
    }
  return 0;
}
