#include "encoder/pipeline/phase_clock.h"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <cstring>

namespace meshfront {
namespace {

constexpr size_t kHeld = size_t{64} << 20;

void holdForAMoment() {
  void* memory = ::mmap(nullptr, kHeld, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  std::memset(memory, 1, kHeld);
  ::munmap(memory, kHeld);
}

TEST(PhaseClock, TellsEachPhasesOwnPeak) {
  std::vector<PhaseTime> phases;
  const EncodeProgress progress;
  PhaseClock clock(phases, progress);
  clock.begin("before");
  clock.begin("large");
  holdForAMoment();
  clock.begin("after");
  clock.end();
  ASSERT_EQ(phases.size(), 3U);
  EXPECT_EQ(phases[1].name, "large");
  EXPECT_GT(phases[1].peakBytes, phases[0].peakBytes + kHeld / 2);
  EXPECT_GT(phases[1].peakBytes, phases[2].peakBytes + kHeld / 2);
}

TEST(PhaseClock, ReportsWhatBegins) {
  std::vector<PhaseTime> phases;
  std::vector<std::pair<std::string, double>> told;
  const EncodeProgress progress = [&](const std::string& name, double done) {
    told.emplace_back(name, done);
  };
  {
    PhaseClock clock(phases, progress);
    clock.begin("one");
    clock.report(0.5);
    clock.begin("two");
  }
  EXPECT_EQ(told,
            (std::vector<std::pair<std::string, double>>{{"one", 0}, {"one", 0.5}, {"two", 0}}));
  ASSERT_EQ(phases.size(), 2U);
  EXPECT_GE(phases[0].seconds, 0);
}

}  // namespace
}  // namespace meshfront
