// The parts of the load generator, and a run of it over a transport that answers at once.
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <optional>
#include <string>
#include <thread>

#include "load/load_run.h"
#include "load/measured_transport.h"
#include "load/mesh_check.h"
#include "load/metrics_page.h"
#include "load/view_choice.h"
#include "tests/data/temporary_folder.h"
#include "tests/unit/mesh_service.h"

namespace meshfront {
namespace {

std::string viewFile(const TemporaryFolder& folder, const std::string& text) {
  const auto path = folder.path() / "views.txt";
  std::ofstream(path) << text;
  return path.string();
}

TEST(ViewChoice, DrawsTheFirstViewsMostAndRepeatsWithItsSeed) {
  const TemporaryFolder folder;
  std::string lines = "# views\n\n";
  for (int i = 0; i < 50; ++i) lines += "azimuth=" + std::to_string(i) + "\r\n";
  const std::string file = viewFile(folder, lines);
  const auto draw = [&](uint64_t seed) {
    auto choice = ViewChoice::read("zipf:" + file, 1, seed);
    EXPECT_TRUE(choice) << choice.error().message;
    EXPECT_EQ(choice->size(), 50U);
    std::vector<size_t> drawn;
    drawn.reserve(20'000);
    for (int i = 0; i < 20'000; ++i) drawn.push_back(choice->next());
    return drawn;
  };
  const std::vector<size_t> drawn = draw(7);
  EXPECT_EQ(drawn, draw(7));
  EXPECT_NE(drawn, draw(8));
  const auto count = [&](size_t view) {
    return static_cast<double>(std::count(drawn.begin(), drawn.end(), view));
  };
  EXPECT_NEAR(count(0) / count(1), 2, 0.2);
  EXPECT_NEAR(count(0) / count(9), 10, 2);
  EXPECT_GT(count(49), 0);
}

TEST(ViewChoice, TakesEachLineInTurn) {
  const TemporaryFolder folder;
  const std::string file = viewFile(folder, "whole\nhalf\nclose;azimuth=4");
  auto choice = ViewChoice::read("each:" + file, 1, 1);
  ASSERT_TRUE(choice) << choice.error().message;
  for (const size_t expected : {0U, 1U, 2U, 0U, 1U}) EXPECT_EQ(choice->next(), expected);
  EXPECT_EQ(choice->view(1).zoom, 2);
}

TEST(ViewChoice, SaysWhatIsWrong) {
  const TemporaryFolder folder;
  const auto problem = [](const std::string& text) {
    const auto choice = ViewChoice::read(text, 1, 1);
    return choice ? std::string() : choice.error().message;
  };
  EXPECT_NE(problem("uniform:x").find("zipf:FILE"), std::string::npos);
  EXPECT_NE(problem("zipf:/nowhere/at/all").find("cannot be read"), std::string::npos);
  const std::string file = viewFile(folder, "whole\nazimut=3\n");
  EXPECT_NE(problem("each:" + file).find("line 2"), std::string::npos);
  EXPECT_NE(problem("each:" + viewFile(folder, "# none\n")).find("none"), std::string::npos);
  EXPECT_NE(problem("each:" + viewFile(folder, "")).find("none"), std::string::npos);
  EXPECT_NE(problem("each:" + viewFile(folder, "whole\n\x80\x01\n")).find("line 2 is no text"),
            std::string::npos);
}

TEST(DurationPercentiles, AreRightToTwoPercent) {
  DurationPercentiles durations;
  EXPECT_EQ(durations.percentile(50), 0);
  for (int i = 1; i <= 1'000; ++i) durations.add(std::chrono::milliseconds(i));
  EXPECT_EQ(durations.count(), 1'000U);
  EXPECT_NEAR(durations.percentile(50), 0.5, 0.5 * 0.03);
  EXPECT_NEAR(durations.percentile(99), 0.99, 0.99 * 0.03);
  EXPECT_EQ(durations.percentile(100), 1);
  EXPECT_EQ(durations.longest(), 1);
  durations.add(std::chrono::hours(1'000'000));
  durations.add(std::chrono::seconds(-1));
  EXPECT_EQ(durations.percentile(0.01), 1e-6);
}

TEST(MetricsPage, SumsSamplesByNameAndLabel) {
  const MetricsPage page = MetricsPage::parse(
      "# HELP a_total Things.\n# TYPE a_total counter\na_total{kind=\"x y\",n=\"1\"} 3\n"
      "a_total{kind=\"z\"} 4.5e1\na_total_more 7\nb 2 1700000000\nnonsense\n{} \nc nan-sense");
  EXPECT_EQ(page.sum("a_total"), 48);
  EXPECT_EQ(page.sum("a_total", "kind=\"x y\""), 3);
  EXPECT_EQ(page.sum("b"), 2);
  EXPECT_EQ(page.sum("a"), 0);
}

// Answers from a service in memory, before send() returns; every `damagedEvery`-th answer with
// records is damaged.
class InstantTransport final : public Transport {
 public:
  explicit InstantTransport(const MeshService& service) : service_(service) {}
  [[nodiscard]] FetchId send(FetchRequest request, Completion completion) override {
    FetchResponse response;
    if (gone) {
      response.error = {ErrorCode::unavailable, "no answer from host"};
    } else {
      response = service_.answer(request);
      const bool records = request.url.find("/splits") != std::string::npos;
      if (damaged && records) response.body.front() ^= 1;
    }
    completion(std::move(response));
    return ++last_;
  }
  void cancel(FetchId) override {}

  std::atomic<bool> damaged = false;
  std::atomic<bool> gone = false;

 private:
  const MeshService& service_;
  std::atomic<FetchId> last_{0};
};

// Answers every request alike, or never.
class AnswerForAll final : public Transport {
 public:
  explicit AnswerForAll(std::optional<FetchResponse> response) : response_(std::move(response)) {}
  [[nodiscard]] FetchId send(FetchRequest, Completion completion) override {
    if (response_) completion(*response_);
    return 1;
  }
  void cancel(FetchId) override {}

 private:
  const std::optional<FetchResponse> response_;
};

FetchResponse answerOf(unsigned status, const std::string& body = {}) {
  FetchResponse response;
  response.status = status;
  response.body.assign(body.begin(), body.end());
  return response;
}

TEST(MeshCheck, RefusesWhatCannotBeRight) {
  const MeshUrl url = *parseMeshUrl("http://host/v1/meshes/torus");
  const auto problem = [&](FetchResponse response) {
    AnswerForAll transport(std::move(response));
    const Result<void> checked = checkMesh(url, transport);
    return checked ? std::string() : checked.error().message;
  };
  const std::string missing = problem(answerOf(404, R"({"title": "Not Found"})"));
  EXPECT_NE(missing.find("no mesh 'torus' at http://host (HTTP 404: Not Found)"),
            std::string::npos);
  EXPECT_NE(problem(answerOf(403)).find("refused: HTTP 403"), std::string::npos);
  EXPECT_NE(problem(answerOf(301)).find("refused: HTTP 301"), std::string::npos);
  EXPECT_NE(problem(answerOf(200, "<html>")).find("no mesh of the v1"), std::string::npos);
  FetchResponse endless;
  endless.error = {ErrorCode::tooLarge, "too much"};
  EXPECT_NE(problem(endless).find("too much"), std::string::npos);
}

TEST(MeshCheck, LetsReceiversWaitForAServerThatIsAway) {
  const MeshUrl url = *parseMeshUrl("http://host/v1/meshes/torus");
  for (const unsigned status : {0U, 429U, 500U, 502U, 503U, 504U}) {
    FetchResponse response = answerOf(status);
    response.error = {ErrorCode::unavailable, "gone"};
    AnswerForAll transport(std::move(response));
    EXPECT_TRUE(checkMesh(url, transport)) << status;
  }
  const MeshService service{TestMesh::torus(32, 16)};
  InstantTransport transport(service);
  EXPECT_TRUE(checkMesh(url, transport));
}

class LoadRunTest : public ::testing::Test {
 protected:
  LoadResult run(LoadRunOptions options) {
    options.url = *parseMeshUrl("http://host/v1/meshes/torus");
    const std::string file = viewFile(folder_, "whole\nhalf\nclose;azimuth=100\n");
    LoadRun load(options, *ViewChoice::read("each:" + file, 1, 1), measured_);
    load.start();
    while (!load.finished()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return load.end();
  }

  TemporaryFolder folder_;
  MeshService service_{TestMesh::torus(32, 16)};
  InstantTransport transport_{service_};
  MeasuredTransport measured_{transport_};
};

TEST_F(LoadRunTest, EveryReceiverSettlesAndNoMoreThanAllowedAreAlive) {
  for (const FetchMode mode : {FetchMode::exact, FetchMode::chunks}) {
    const uint64_t before = measured_.counts().requests;
    LoadRunOptions options;
    options.receivers = 30;
    options.concurrency = 5;
    options.workers = 2;
    options.receiver.mode = mode;
    const LoadResult result = run(options);
    EXPECT_EQ(result.started, 30U);
    EXPECT_EQ(result.settled, 30U);
    EXPECT_EQ(result.failed, 0U);
    EXPECT_EQ(result.unfinished, 0U);
    EXPECT_LE(result.mostAlive, 5U);
    EXPECT_EQ(result.settling.count(), 30U);
    EXPECT_GT(result.records, 30 * 50U);
    const TransportCounts counts = measured_.counts();
    EXPECT_GT(counts.requests, before + 30 * 3U);
    EXPECT_TRUE(counts.errors.empty());
    EXPECT_GT(counts.recordBytes, 0U);
    EXPECT_EQ(counts.latency.count(), counts.requests);
  }
}

TEST_F(LoadRunTest, CountsReceiversThatFail) {
  transport_.damaged = true;
  LoadRunOptions options;
  options.receivers = 4;
  options.concurrency = 2;
  options.workers = 2;
  options.receiver.resumeInterval = std::chrono::milliseconds(10);
  const LoadResult result = run(options);
  EXPECT_EQ(result.failed, 4U);
  EXPECT_EQ(result.settled, 0U);
  EXPECT_GE(result.malformed, 8U);
  ASSERT_EQ(result.failures.size(), 1U);
  EXPECT_NE(result.failures.begin()->first.find("damaged"), std::string::npos);
}

TEST_F(LoadRunTest, TriesAgainWhileTheServerIsAway) {
  transport_.gone = true;
  LoadRunOptions options;
  options.receivers = 3;
  options.concurrency = 3;
  options.receiver.patience = std::chrono::seconds(60);
  options.receiver.resumeInterval = std::chrono::milliseconds(20);
  std::thread server([this] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    transport_.gone = false;
  });
  const LoadResult result = run(options);
  server.join();
  EXPECT_EQ(result.settled, 3U);
  EXPECT_EQ(result.failed, 0U);
  EXPECT_GE(result.resumed, 3U);
  EXPECT_GE(measured_.counts().errors.at("no answer"), 3U);
}

TEST_F(LoadRunTest, GivesUpWhenTimeIsOver) {
  transport_.gone = true;
  LoadRunOptions options;
  options.receivers = 1'000;
  options.concurrency = 3;
  options.duration = std::chrono::milliseconds(50);
  const LoadResult result = run(options);
  EXPECT_EQ(result.unfinished, 3U);
  EXPECT_EQ(result.started, 3U);
  EXPECT_EQ(result.failed, 0U);
}

}  // namespace
}  // namespace meshfront
