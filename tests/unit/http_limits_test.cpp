// What the server does with clients that take too much or too long, over real sockets. Times are
// short so that the tests are; none of them expects anything to happen soon.
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <thread>

#include "shared/http/server/access_log.h"
#include "shared/http/server/http_front.h"
#include "tests/data/temporary_folder.h"
#include "tests/unit/raw_client.h"

namespace meshfront {
namespace {

// "/N": N octets.
class SizedHandler final : public HttpHandler {
 public:
  std::optional<HttpResponse> answerAtOnce(const HttpRequest& request) override {
    return answer(request);
  }
  HttpResponse answer(const HttpRequest& request) override {
    HttpResponse response;
    if (request.contentTooLarge) response.status = 413;
    const size_t size = std::strtoul(std::string(request.target.substr(1)).c_str(), nullptr, 10);
    response.content = HeldBytes::of(std::string(size, 'x'));
    return response;
  }
  HttpResponse overloaded(const HttpRequest&) override { return {}; }
};

class HttpLimitsTest : public ::testing::Test {
 protected:
  void start(const ServerLimits& limits, unsigned waitingThreads = 0) {
    log_ = *AccessLog::open(folder_ / "log", AccessLog::Format::text);
    auto front = HttpFront::start(handler_, {.address = *resolveListenAddress("127.0.0.1:0"),
                                             .waitingThreads = waitingThreads,
                                             .limits = limits,
                                             .metrics = &metrics_,
                                             .accessLog = log_.get()});
    ASSERT_TRUE(front) << front.error().message;
    front_ = std::move(*front);
  }
  [[nodiscard]] uint64_t counted(const std::string& sample) const {
    const std::string text = "\n" + metrics_.text();
    const size_t at = text.find("\n" + sample + " ");
    return at == std::string::npos ? 0 : std::stoull(text.substr(at + sample.size() + 2));
  }
  void waitFor(const std::string& sample, uint64_t value) const {
    while (counted(sample) != value) std::this_thread::yield();  // hangs if it never is
  }
  // Ends the server and returns what it has logged.
  std::string logged() {
    front_.reset();
    log_.reset();
    std::ifstream in(folder_ / "log");
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void expectProblem(const std::string& response, unsigned status) {
    EXPECT_TRUE(response.starts_with("HTTP/1.1 " + std::to_string(status))) << response;
    EXPECT_NE(response.find("application/problem+json"), std::string::npos) << response;
    EXPECT_NE(response.find("\"status\":" + std::to_string(status)), std::string::npos);
    EXPECT_NE(response.find("Access-Control-Allow-Origin: *"), std::string::npos);
  }
  static bool isFine(const std::string& response) { return response.starts_with("HTTP/1.1 200"); }

  TemporaryFolder folder_;
  SizedHandler handler_;
  Metrics metrics_;
  std::unique_ptr<AccessLog> log_;
  std::unique_ptr<HttpFront> front_;
};

constexpr double kSoon = 0.3;

TEST_F(HttpLimitsTest, CutsARequestLineThatTrickles) {
  start({.headerTimeout = kSoon});
  RawClient client(front_->port());
  client.trickle("GET /aaaaaaaaaa");
  expectProblem(client.receiveAll(), 408);
  EXPECT_EQ(counted("meshfront_cut_total{phase=\"line\"}"), 1U);
  EXPECT_NE(logged().find("127.0.0.1 - - "), std::string::npos);
}

TEST_F(HttpLimitsTest, CutsTheSecondRequestLineThatTrickles) {
  start({.headerTimeout = kSoon});
  RawClient client(front_->port());
  EXPECT_TRUE(isFine(client.ask("/5")));
  client.trickle("GET /aaaaaaaaaa");
  expectProblem(client.receiveAll(), 408);
  EXPECT_EQ(counted("meshfront_cut_total{phase=\"line\"}"), 1U);
}

TEST_F(HttpLimitsTest, CutsFieldsThatTrickle) {
  start({.headerTimeout = kSoon});
  RawClient client(front_->port());
  client.send("GET /slow HTTP/1.1\r\nHost: x\r\n");
  client.trickle("A: b\r\n");
  expectProblem(client.receiveAll(), 408);
  waitFor("meshfront_requests_in_flight", 0);
  EXPECT_EQ(counted("meshfront_cut_total{phase=\"header\"}"), 1U);
  EXPECT_NE(logged().find("\" 408 0 "), std::string::npos);
}

TEST_F(HttpLimitsTest, CutsContentThatTrickles) {
  start({.contentTimeout = kSoon});
  for (const char* length : {"Content-Length: 1000000", "Transfer-Encoding: chunked"}) {
    RawClient client(front_->port());
    client.send(std::string("QUERY /q HTTP/1.1\r\nHost: x\r\n") + length + "\r\n\r\n");
    client.trickle("1\r\na\r\n");
    expectProblem(client.receiveAll(), 408);
  }
  EXPECT_EQ(counted("meshfront_cut_total{phase=\"content\"}"), 2U);
  EXPECT_EQ(logged().find("\" 200 "), std::string::npos);
}

TEST_F(HttpLimitsTest, CutsClientsThatDoNotTakeTheirAnswer) {
  start({.answerTimeout = kSoon});
  RawClient client(front_->port(), 4096);
  client.send("GET /50000000 HTTP/1.1\r\nHost: x\r\n\r\n");
  waitFor("meshfront_cut_total{phase=\"answer\"}", 1);
  waitFor("meshfront_unfinished_total", 1);
  waitFor("meshfront_in_flight_bytes", 0);
  EXPECT_TRUE(isFine(RawClient(front_->port()).ask("/5")));
  EXPECT_NE(logged().find(" cut\n"), std::string::npos);
}

TEST_F(HttpLimitsTest, KeepsIdleConnections) {
  start({.headerTimeout = 0.1});
  RawClient first(front_->port());
  RawClient second(front_->port());
  EXPECT_TRUE(isFine(first.ask("/5")));
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  EXPECT_TRUE(isFine(first.ask("/5")));
  EXPECT_TRUE(isFine(second.ask("/5")));
}

TEST_F(HttpLimitsTest, ClosesConnectionsThatAreIdleForTooLong) {
  start({.idleTimeout = 1});
  RawClient client(front_->port());
  EXPECT_TRUE(isFine(client.ask("/5")));
  EXPECT_EQ(client.receiveAll(), "");  // hangs if it stays open
}

TEST_F(HttpLimitsTest, RefusesConnectionsBeyondThoseOfAnAddress) {
  start({.maxConnectionsPerAddress = 2});
  std::optional<RawClient> first(front_->port());
  RawClient second(front_->port());
  EXPECT_TRUE(isFine(first->ask("/5")));
  EXPECT_TRUE(isFine(second.ask("/5")));
  {
    RawClient third(front_->port());
    const std::string response = third.ask("/5");
    expectProblem(response, 429);
    EXPECT_NE(response.find("Retry-After: "), std::string::npos);
    EXPECT_EQ(third.receiveAll(), "");  // closed
  }
  EXPECT_TRUE(isFine(second.ask("/5")));
  EXPECT_EQ(counted("meshfront_refused_total{reason=\"address\"}"), 1U);
  waitFor("meshfront_connections_open", 2);
  first.reset();
  waitFor("meshfront_connections_open", 1);
  EXPECT_TRUE(isFine(RawClient(front_->port()).ask("/5")));
  EXPECT_NE(logged().find("\" 429 "), std::string::npos);
}

TEST_F(HttpLimitsTest, ClosesAtOnceWhereTooManyWaitForTheirRefusal) {
  start({.maxConnectionsPerAddress = 2});
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 4; ++i) {
    clients.push_back(std::make_unique<RawClient>(front_->port()));
    waitFor("meshfront_connections_total", static_cast<uint64_t>(i) + 1);
  }
  EXPECT_EQ(RawClient(front_->port()).receiveAll(), "");
  EXPECT_TRUE(isFine(clients[0]->ask("/5")));
}

TEST_F(HttpLimitsTest, RefusesConnectionsBeyondAll) {
  start({.maxConnections = 2});
  RawClient first(front_->port());
  RawClient second(front_->port());
  EXPECT_TRUE(isFine(first.ask("/5")));
  EXPECT_TRUE(isFine(second.ask("/5")));
  RawClient third(front_->port());
  const std::string response = third.ask("/5");
  expectProblem(response, 503);
  EXPECT_NE(response.find("Retry-After: "), std::string::npos);
  EXPECT_EQ(front_->maxConnections(), 2U);
}

TEST_F(HttpLimitsTest, CutsRefusedConnectionsThatNeverAsk) {
  start({.maxConnections = 1, .headerTimeout = kSoon});
  RawClient first(front_->port());
  EXPECT_TRUE(isFine(first.ask("/5")));
  EXPECT_EQ(RawClient(front_->port()).receiveAll(), "");  // hangs if it stays open
  EXPECT_TRUE(isFine(first.ask("/5")));
  EXPECT_EQ(counted("meshfront_cut_total{phase=\"idle\"}"), 1U);
}

TEST_F(HttpLimitsTest, RefusesLongFields) {
  start({});
  RawClient client(front_->port());
  const std::string field = "A: " + std::string(8000, 'b') + "\r\n";
  client.send("GET /5 HTTP/1.1\r\nHost: x\r\n" + field + field + field + "\r\n");
  EXPECT_TRUE(isFine(client.receive()));
  client.send("GET /5 HTTP/1.1\r\nHost: x\r\n" + field + field + field + field + field + "\r\n");
  expectProblem(client.receive(), 431);
}

class HttpMemoryTest : public HttpLimitsTest, public ::testing::WithParamInterface<unsigned> {};
INSTANTIATE_TEST_SUITE_P(WaitingThreads, HttpMemoryTest, ::testing::Values(0U, 1U));

TEST_P(HttpMemoryTest, IsBoundedForAllRequestsTogether) {
  start({.memoryInFlight = 100'000}, GetParam());
  RawClient client(front_->port());
  EXPECT_TRUE(isFine(client.ask("/100000")));
  waitFor("meshfront_requests_in_flight", 0);
  const std::string response = client.ask("/100001");
  expectProblem(response, 503);
  EXPECT_NE(response.find("Retry-After: "), std::string::npos);
  client.send("QUERY /5 HTTP/1.1\r\nHost: x\r\nContent-Length: 100001\r\n\r\n" +
              std::string(100'001, 'a'));
  expectProblem(client.receive(), 503);
  waitFor("meshfront_in_flight_bytes", 0);
  client.send("QUERY /5 HTTP/1.1\r\nHost: x\r\nContent-Length: 90000\r\n\r\n" +
              std::string(90'000, 'a'));
  EXPECT_TRUE(isFine(client.receive()));
  EXPECT_EQ(counted("meshfront_refused_total{reason=\"memory\"}"), 2U);
}

TEST_F(HttpLimitsTest, RefusesContentBeyondTheLimit) {
  start({.maxContent = 2000});
  RawClient client(front_->port());
  client.send("QUERY /5 HTTP/1.1\r\nHost: x\r\nContent-Length: 2000\r\n\r\n" +
              std::string(2000, 'a'));
  EXPECT_TRUE(isFine(client.receive()));
  client.send("QUERY /5 HTTP/1.1\r\nHost: x\r\nContent-Length: 2001\r\n\r\n" +
              std::string(2001, 'a'));
  EXPECT_TRUE(client.receive().starts_with("HTTP/1.1 413"));
}

TEST_F(HttpLimitsTest, CountsAndLogsRequests) {
  start({});
  RawClient client(front_->port());
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(isFine(client.ask("/7\"\xFF")));
  waitFor("meshfront_request_seconds_count", 3);
  EXPECT_EQ(counted("meshfront_request_seconds_bucket{le=\"+Inf\"}"), 3U);
  EXPECT_EQ(counted("meshfront_connections_total"), 1U);
  EXPECT_EQ(counted("meshfront_unfinished_total"), 0U);
  const std::string log = logged();
  EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), 3) << log;
  EXPECT_NE(log.find("\"GET /7\\x22\\xFF HTTP/1.1\" 200 7 0."), std::string::npos) << log;
}

}  // namespace
}  // namespace meshfront
