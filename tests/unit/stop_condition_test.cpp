#include "viewer/run/stop_condition.h"

#include <gtest/gtest.h>

namespace meshfront {
namespace {

using Kind = StopCondition::Kind;

TEST(StopCondition, ReadsEveryForm) {
  EXPECT_EQ(parseStopCondition("settled")->kind, Kind::settled);
  EXPECT_EQ(parseStopCondition("complete")->kind, Kind::complete);
  const std::pair<const char*, uint64_t> amounts[] = {
      {"0", 0},          {"20000", 20'000},      {"20kB", 20'000},
      {"20B", 20},       {"1.5MB", 1'500'000},   {"64KiB", 65'536},
      {"2MiB", 2 << 20}, {"1GB", 1'000'000'000}, {"1GiB", 1 << 30}};
  for (const auto& [text, octets] : amounts) {
    const auto condition = parseStopCondition(text);
    ASSERT_TRUE(condition) << text;
    EXPECT_EQ(condition->kind, Kind::bytes) << text;
    EXPECT_EQ(condition->amount, octets) << text;
  }
  EXPECT_EQ(parseStopCondition("records:500")->kind, Kind::records);
  EXPECT_EQ(parseStopCondition("records:500")->amount, 500U);
  EXPECT_EQ(parseStopCondition("psnr:35.5")->kind, Kind::psnr);
  EXPECT_DOUBLE_EQ(parseStopCondition("psnr:35.5")->decibels, 35.5);
}

TEST(StopCondition, RefusesEverythingElse) {
  for (const char* text : {"", "done", "-5", "20 kB", "20k", "20kb", "kB", "1e30", "nan", "inf",
                           "records:", "records:1.5", "records:5x", "records:-1",
                           "psnr:", "psnr:high", "psnr:35dBm", "settled "}) {
    const auto condition = parseStopCondition(text);
    ASSERT_FALSE(condition) << text;
    EXPECT_NE(condition.error().message.find("records:N"), std::string::npos);
  }
}

}  // namespace
}  // namespace meshfront
