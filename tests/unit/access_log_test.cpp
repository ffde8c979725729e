#include "shared/http/server/access_log.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/data/temporary_folder.h"

namespace meshfront {
namespace {

using LogFormat = AccessLog::Format;

constexpr int64_t kLogTime = 1'795'342'500;  // 2026-11-22 10:15:00 UTC

AccessLog::Entry someLogEntry() {
  return {.address = "192.0.2.1",
          .method = "GET",
          .target = "/v1/meshes?x=1",
          .status = 200,
          .bytes = 1234,
          .seconds = 0.0003214};
}

std::string logText(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(AccessLog, WritesTheCommonFormat) {
  EXPECT_EQ(AccessLog::line(someLogEntry(), LogFormat::text, kLogTime),
            "192.0.2.1 - - [22/Nov/2026:10:15:00 +0000] \"GET /v1/meshes?x=1 HTTP/1.1\" 200 1234 "
            "0.000321\n");
  AccessLog::Entry cut = someLogEntry();
  cut.version10 = true;
  cut.whole = false;
  EXPECT_EQ(AccessLog::line(cut, LogFormat::text, kLogTime),
            "192.0.2.1 - - [22/Nov/2026:10:15:00 +0000] \"GET /v1/meshes?x=1 HTTP/1.0\" 200 1234 "
            "0.000321 cut\n");
  EXPECT_EQ(AccessLog::line({.address = "::1", .status = 408, .seconds = 10}, LogFormat::text, 0),
            "::1 - - [01/Jan/1970:00:00:00 +0000] \"-\" 408 0 10.000000\n");
}

TEST(AccessLog, WritesJson) {
  EXPECT_EQ(AccessLog::line(someLogEntry(), LogFormat::json, kLogTime),
            "{\"time\":\"2026-11-22T10:15:00Z\",\"address\":\"192.0.2.1\",\"method\":\"GET\","
            "\"target\":\"/v1/meshes?x=1\",\"status\":200,\"bytes\":1234,\"seconds\":0.000321,"
            "\"whole\":true}\n");
}

TEST(AccessLog, EscapesWhateverAClientSends) {
  std::string all;
  for (int octet = 1; octet < 256; ++octet) all.push_back(static_cast<char>(octet));
  AccessLog::Entry entry = someLogEntry();
  entry.target = all;
  const std::string text = AccessLog::line(entry, LogFormat::text, kLogTime);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  EXPECT_EQ(std::count(text.begin(), text.end(), '"'), 2);
  for (const char c : text.substr(0, text.size() - 1)) EXPECT_TRUE(c >= 0x20 && c < 0x7F);
  EXPECT_NE(text.find("\\x0A"), std::string::npos);
  EXPECT_NE(text.find("\\x22"), std::string::npos);
  EXPECT_NE(text.find("\\x5C"), std::string::npos);
  EXPECT_NE(text.find("\\xFF"), std::string::npos);

  const auto json = nlohmann::json::parse(AccessLog::line(entry, LogFormat::json, kLogTime));
  const std::string back = json["target"];  // UTF-8 of the same code points
  EXPECT_EQ(back.substr(0, 127), all.substr(0, 127));
  EXPECT_EQ(back.size(), 127U + 2 * 128);
}

TEST(AccessLog, WritesAllLinesOfAllThreads) {
  const TemporaryFolder folder;
  constexpr int kThreads = 4;
  constexpr int kLines = 500;
  {
    auto log = AccessLog::open(folder / "log", LogFormat::json);
    ASSERT_TRUE(log) << log.error().message;
    std::vector<std::thread> threads;
    threads.reserve(kThreads);
    for (int i = 0; i < kThreads; ++i)
      threads.emplace_back([&log] {
        for (int line = 0; line < kLines; ++line) (*log)->add(someLogEntry());
      });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ((*log)->dropped(), 0U);
  }
  std::ifstream in(folder / "log");
  int lines = 0;
  for (std::string line; std::getline(in, line); ++lines)
    EXPECT_TRUE(nlohmann::json::accept(line)) << line;
  EXPECT_EQ(lines, kThreads * kLines);
}

TEST(AccessLog, AppendsAndOpensAnew) {
  const TemporaryFolder folder;
  std::ofstream(folder / "log") << "before\n";
  auto log = *AccessLog::open(folder / "log", LogFormat::text);
  std::filesystem::rename(folder / "log", folder / "moved");
  ASSERT_TRUE(log->reopen());
  log->add(someLogEntry());
  log.reset();
  EXPECT_EQ(logText(folder / "moved"), "before\n");
  EXPECT_NE(logText(folder / "log").find("GET /v1/meshes"), std::string::npos);
}

TEST(AccessLog, KeepsTheOldFileWhereItCannotBeOpenedAnew) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "logs");
  auto log = *AccessLog::open(folder / "logs/log", LogFormat::text);
  std::filesystem::rename(folder / "logs", folder / "moved");
  const auto opened = log->reopen();
  ASSERT_FALSE(opened);
  EXPECT_NE(opened.error().message.find("logs/log"), std::string::npos);
  log->add(someLogEntry());
  log.reset();
  EXPECT_NE(logText(folder / "moved/log"), "");
}

TEST(AccessLog, NeverWaitsForAReader) {
  const TemporaryFolder folder;
  const std::string path = folder / "pipe";
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const int reader = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  ASSERT_GE(reader, 0);
  auto log = *AccessLog::open(path, LogFormat::text);
  AccessLog::Entry entry = someLogEntry();
  const std::string target(8000, 'a');
  entry.target = target;
  for (int i = 0; i < 1000; ++i) log->add(entry);  // 8 MB: neither the pipe nor the buffer hold it
  EXPECT_GT(log->dropped(), 0U);
  log.reset();  // ends, although nobody reads
  ::close(reader);
}

TEST(AccessLog, SaysWhyAFileCannotBeOpened) {
  const TemporaryFolder folder;
  const auto log = AccessLog::open(folder / "no/such/folder", LogFormat::text);
  ASSERT_FALSE(log);
  EXPECT_NE(log.error().message.find("No such file"), std::string::npos);
}

}  // namespace
}  // namespace meshfront
