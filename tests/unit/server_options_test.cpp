#include "shared/http/server/server_options.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

namespace meshfront {
namespace {

struct ParsedOptions {
  std::optional<int> status;
  ServerOptions options;
};

ParsedOptions parseArguments(std::vector<const char*> arguments) {
  ParsedOptions parsed;
  parsed.options.listen = "127.0.0.1:0";
  CLI::App app("A server.");
  addServerOptions(app, parsed.options);
  arguments.insert(arguments.begin(), "server");
  parsed.status =
      parseServerOptions(app, static_cast<int>(arguments.size()), arguments.data(), parsed.options);
  return parsed;
}

TEST(ServerOptions, HaveDefaults) {
  const ParsedOptions parsed = parseArguments({});
  EXPECT_FALSE(parsed.status);
  const ServerLimits defaults;
  EXPECT_EQ(parsed.options.limits.maxContent, defaults.maxContent);
  EXPECT_EQ(parsed.options.limits.idleTimeout, defaults.idleTimeout);
  EXPECT_EQ(parsed.options.address.host, "127.0.0.1");
  EXPECT_EQ(parsed.options.accessLog, "");
  EXPECT_GE(parsed.options.threads, 1U);
}

TEST(ServerOptions, SetEveryLimit) {
  const ParsedOptions parsed = parseArguments({"--max-target",
                                               "9000",
                                               "--max-header",
                                               "16KiB",
                                               "--max-content",
                                               "2MiB",
                                               "--max-ids",
                                               "5",
                                               "--max-levels",
                                               "6",
                                               "--max-records",
                                               "7",
                                               "--max-answer",
                                               "8MiB",
                                               "--max-connections",
                                               "9",
                                               "--header-timeout",
                                               "0.5",
                                               "--content-timeout",
                                               "1.5",
                                               "--answer-timeout",
                                               "2.5",
                                               "--idle-timeout",
                                               "3.5",
                                               "--max-connections-per-address",
                                               "10",
                                               "--memory-in-flight",
                                               "11MiB"});
  ASSERT_FALSE(parsed.status);
  const ServerLimits& limits = parsed.options.limits;
  EXPECT_EQ(limits.maxTarget, 9000U);
  EXPECT_EQ(limits.maxHeader, size_t{16} << 10);
  EXPECT_EQ(limits.maxContent, size_t{2} << 20);
  EXPECT_EQ(limits.maxIds, 5U);
  EXPECT_EQ(limits.maxLevels, 6U);
  EXPECT_EQ(limits.maxRecords, 7U);
  EXPECT_EQ(limits.maxAnswer, size_t{8} << 20);
  EXPECT_EQ(limits.maxConnections, 9U);
  EXPECT_EQ(limits.maxConnectionsPerAddress, 10U);
  EXPECT_EQ(limits.headerTimeout, 0.5);
  EXPECT_EQ(limits.contentTimeout, 1.5);
  EXPECT_EQ(limits.answerTimeout, 2.5);
  EXPECT_EQ(limits.idleTimeout, 3.5);
  EXPECT_EQ(limits.memoryInFlight, size_t{11} << 20);

  const RecordService::Options service = serviceOptions(limits, "1.1 test");
  EXPECT_EQ(service.limits.maxWanted, 5U);
  EXPECT_EQ(service.limits.maxRecords, 7U);
  EXPECT_EQ(service.limits.maxBytes, size_t{8} << 20);
  EXPECT_EQ(service.maxTarget, 9000U);
  EXPECT_EQ(service.maxContent, size_t{2} << 20);
  EXPECT_EQ(service.maxLevels, 6U);
  EXPECT_EQ(service.via, "1.1 test");
}

TEST(ServerOptions, TakeTheAccessLog) {
  EXPECT_EQ(parseArguments({"--access-log", "-"}).options.accessLog, "-");
  EXPECT_EQ(parseArguments({"--access-log-format", "json"}).options.accessLogFormat,
            AccessLog::Format::json);
}

TEST(ServerOptions, RefuseWrongUsage) {
  for (const std::vector<const char*>& wrong : std::vector<std::vector<const char*>>{
           {"--max-target", "7999"},
           {"--max-levels", "64"},
           {"--max-ids", "0"},
           {"--max-ids", "-1"},
           {"--max-content", "much"},
           {"--header-timeout", "0"},
           {"--header-timeout", "soon"},
           {"--memory-in-flight", "64MiB"},  // less than an answer and a content
           {"--access-log-format", "xml"},
           {"--threads", "0"},
           {"--listen", "nowhere"},
           {"--unknown"}}) {
    ::testing::internal::CaptureStderr();
    const ParsedOptions parsed = parseArguments(wrong);
    EXPECT_NE(::testing::internal::GetCapturedStderr(), "") << wrong[0];
    EXPECT_EQ(parsed.status, kUsageStatus) << wrong[0];
  }
}

TEST(ServerOptions, HelpShowsTheTableWithUnitsAndDefaults) {
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(parseArguments({"--help"}).status, 0);
  const std::string help = ::testing::internal::GetCapturedStdout();
  for (const char* part : {"Limits", "--max-content SIZE=1MiB", "--header-timeout SECONDS=10",
                           "--max-connections COUNT=16384", "--max-target OCTETS=8000"})
    EXPECT_NE(help.find(part), std::string::npos) << part << " in\n" << help;
}

}  // namespace
}  // namespace meshfront
