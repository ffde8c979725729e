// What the server says to octets on the wire that no well-behaved client sends, or sends seldom.
#include <gtest/gtest.h>

#include <fstream>
#include <future>

#include "shared/http/server/http_front.h"
#include "tests/data/temporary_folder.h"
#include "tests/unit/raw_client.h"

namespace meshfront {
namespace {

// Says what it was asked; a target that begins with /wait takes a worker.
class WireHandler final : public HttpHandler {
 public:
  std::optional<HttpResponse> answerAtOnce(const HttpRequest& request) override {
    if (request.target.starts_with("/wait")) return std::nullopt;
    return answer(request);
  }
  HttpResponse answer(const HttpRequest& request) override {
    HttpResponse response;
    if (request.target == "/204") {
      response.status = 204;
      return response;
    }
    response.status = request.contentTooLarge ? 413 : request.target == "/304" ? 304 : 200;
    std::string text(request.target);
    text.append(" ").append(request.content.begin(), request.content.end());
    response.content = HeldBytes::of(std::move(text));
    return response;
  }
  HttpResponse overloaded(const HttpRequest&) override { return {}; }
};

class HttpWireTest : public ::testing::Test {
 protected:
  void SetUp() override {
    log_ = *AccessLog::open(folder_ / "log", AccessLog::Format::text);
    front_ = *HttpFront::start(handler_, {.address = *resolveListenAddress("127.0.0.1:0"),
                                          .threads = 2,
                                          .waitingThreads = 2,
                                          .metrics = &metrics_,
                                          .accessLog = log_.get()});
  }
  // All that the server says until it closes the connection.
  std::string said(const std::string& text) {
    RawClient client(front_->port());
    client.send(text);
    return client.receiveAll();
  }
  static std::string get(const std::string& target, const std::string& fields = {}) {
    return "GET " + target + " HTTP/1.1\r\nHost: x\r\n" + fields + "\r\n";
  }
  static std::string contentOf(const std::string& response) {
    const size_t end = response.find("\r\n\r\n");
    return end == std::string::npos ? "" : response.substr(end + 4);
  }
  void expectRefused(const std::string& text, unsigned status) {
    const std::string response = said(text);
    EXPECT_TRUE(response.starts_with("HTTP/1.1 " + std::to_string(status))) << response;
    EXPECT_NE(response.find("\r\nContent-Type: application/problem+json\r\n"), std::string::npos);
    EXPECT_NE(response.find("\r\nAccess-Control-Allow-Origin: *\r\n"), std::string::npos);
    EXPECT_NE(response.find("\r\nConnection: close\r\n"), std::string::npos);
    EXPECT_NE(response.find("\r\nDate: "), std::string::npos);
    EXPECT_NE(response.find("\"status\":" + std::to_string(status)), std::string::npos);
    // Nothing behind it, whatever followed the request.
    EXPECT_EQ(response.find("HTTP/1.1 ", 8), std::string::npos) << response;
  }
  std::string logged() {
    front_.reset();
    log_.reset();
    std::ifstream in(folder_ / "log");
    return {std::istreambuf_iterator<char>(in), {}};
  }

  TemporaryFolder folder_;
  WireHandler handler_;
  Metrics metrics_;
  std::unique_ptr<AccessLog> log_;
  std::unique_ptr<HttpFront> front_;
};

TEST_F(HttpWireTest, RefusesWhatIsNoRequest) {
  expectRefused("hello\r\n\r\n", 400);
  expectRefused(std::string("\x16\x03\x01\x00\xA5", 5), 400);
  expectRefused("GET / HTTP/2.0\r\n\r\n", 505);
  expectRefused("GET / HTTP/1.1\r\nHost : x\r\n\r\n" + get("/smuggled"), 400);
  expectRefused("GET /\x07 HTTP/1.1\r\nHost: x\r\n\r\n", 400);
  expectRefused(get("/", "Transfer-Encoding: gzip\r\n"), 501);
  expectRefused(get("/", "A: b\r\n c\r\n"), 400);
  const std::string log = logged();
  EXPECT_NE(log.find("\"GET /\\x07 HTTP/1.1\" 400 "), std::string::npos) << log;
}

TEST_F(HttpWireTest, RefusesRequestsOfTwoMeanings) {
  const std::string both =
      "QUERY / HTTP/1.1\r\nHost: x\r\nContent-Length: 4\r\nTransfer-Encoding: chunked\r\n\r\n";
  expectRefused(both + "0\r\n\r\n" + get("/smuggled"), 400);
  expectRefused("QUERY / HTTP/1.1\r\nHost: x\r\nContent-Length: 4\r\nContent-Length: 5\r\n\r\n" +
                    get("/smuggled"),
                400);
  expectRefused("QUERY / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n1\r\nab\r\n",
                400);
}

TEST_F(HttpWireTest, RefusesEndlessLinesBeforeTheyEnd) {
  RawClient client(front_->port());
  client.send("GET /" + std::string(70'000, 'a'));  // and no more, until the answer is there
  EXPECT_TRUE(client.receive().starts_with("HTTP/1.1 414"));
  EXPECT_TRUE(client.send(std::string(1 << 20, 'a')));  // is read and dropped
  expectRefused("GET /" + std::string(1 << 20, 'a') + " HTTP/1.1\r\nHost: x\r\n\r\n", 414);
  RawClient fields(front_->port());
  fields.send("GET / HTTP/1.1\r\nHost: x\r\nA: " + std::string(40'000, 'a'));
  EXPECT_TRUE(fields.receive().starts_with("HTTP/1.1 431"));
}

TEST_F(HttpWireTest, AnswersInTheOrderOfTheRequests) {
  std::string requests;
  std::string expected;
  for (int i = 0; i < 200; ++i) {
    const std::string target = (i % 3 == 0 ? "/wait" : "/") + std::to_string(i);
    const std::string content = std::to_string(i);
    if (i % 2 == 0) {
      requests += get(target);
      expected += target + " ;";
    } else {
      requests += "QUERY " + target + " HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n" +
                  std::to_string(content.size()) + "\r\n" + content + "\r\n0\r\n\r\n\r\n";
      expected += target + " " + content + ";";
    }
  }
  for (const size_t piece : {size_t{1}, size_t{7}, requests.size()}) {
    RawClient client(front_->port());
    for (size_t at = 0; at < requests.size(); at += piece) client.send(requests.substr(at, piece));
    std::string received;
    for (int i = 0; i < 200; ++i) received += contentOf(client.receive()) + ";";
    EXPECT_EQ(received, expected);
  }
}

TEST_F(HttpWireTest, TakesContentThatIsAnnouncedOnly) {
  RawClient client(front_->port());
  client.send("QUERY /q HTTP/1.1\r\nHost: x\r\nExpect: 100-continue\r\nContent-Length: 3\r\n\r\n");
  EXPECT_EQ(client.receive(), "HTTP/1.1 100 Continue\r\n\r\n");
  client.send("abc");
  EXPECT_EQ(contentOf(client.receive()), "/q abc");
  // What is refused anyway is not asked for.
  client.send(
      "QUERY /q HTTP/1.1\r\nHost: x\r\nExpect: 100-continue\r\n"
      "Content-Length: 2000000\r\n\r\n");
  EXPECT_TRUE(client.receive().starts_with("HTTP/1.1 413"));
  EXPECT_EQ(client.receiveAll(), "");
}

TEST_F(HttpWireTest, RefusesContentWithoutEnd) {
  RawClient client(front_->port());
  client.send("QUERY /q HTTP/1.1\r\nHost: x\r\nContent-Length: 99999999999999999999999\r\n\r\n");
  EXPECT_TRUE(client.receive().starts_with("HTTP/1.1 413"));
}

TEST_F(HttpWireTest, SendsNoContentWhereThereIsNone) {
  RawClient client(front_->port());
  client.send("HEAD /ab HTTP/1.1\r\nHost: x\r\n\r\n" + get("/204") + get("/304") + get("/z") +
              get("/", "Connection: close\r\n"));
  const std::string all = client.receiveAll();
  EXPECT_EQ(std::count(all.begin(), all.end(), '\n'), 4 + 3 + 4 + 4 + 5) << all;
  EXPECT_NE(all.find("\r\nContent-Length: 4\r\n\r\nHTTP/1.1 204 No Content\r\n"),
            std::string::npos);
  EXPECT_NE(all.find("\r\nContent-Length: 5\r\n\r\nHTTP/1.1 200 OK\r\n"), std::string::npos);
  EXPECT_NE(all.find("\r\n\r\n/z HTTP/1.1 200 OK\r\n"), std::string::npos) << all;
  EXPECT_TRUE(all.ends_with("\r\n\r\n/ "));
}

TEST_F(HttpWireTest, ServesHttp10) {
  const std::string closed = said("GET /a HTTP/1.0\r\n\r\n");
  EXPECT_TRUE(closed.starts_with("HTTP/1.1 200 OK\r\n"));
  EXPECT_NE(closed.find("Connection: close\r\n"), std::string::npos);
  RawClient client(front_->port());
  for (int i = 0; i < 2; ++i) {
    client.send("GET /a HTTP/1.0\r\nConnection: keep-alive\r\n\r\n");
    EXPECT_NE(client.receive().find("Connection: keep-alive\r\n"), std::string::npos);
  }
}

TEST_F(HttpWireTest, AnswersThoseThatSendNoMore) {
  for (const char* target : {"/now", "/wait"}) {
    RawClient client(front_->port());
    client.send(get(target));
    client.endSending();
    EXPECT_EQ(contentOf(client.receiveAll()), std::string(target) + " ");
  }
  RawClient client(front_->port());
  client.send("GET /half");
  client.endSending();
  EXPECT_EQ(client.receiveAll(), "");
}

// Answers once it is let go on.
class HeldUpHandler final : public HttpHandler {
 public:
  std::optional<HttpResponse> answerAtOnce(const HttpRequest&) override { return std::nullopt; }
  HttpResponse answer(const HttpRequest& request) override {
    goOn_.get_future().wait();
    HttpResponse response;
    response.content = HeldBytes::of(std::string(request.target));
    return response;
  }
  HttpResponse overloaded(const HttpRequest&) override { return {}; }
  void goOn() { goOn_.set_value(); }

 private:
  std::promise<void> goOn_;
};

// The answer comes when its connection has gone.
TEST(HttpWire, CutsThoseWhoseAnswerTakesTooLong) {
  HeldUpHandler handler;
  Metrics metrics;
  ServerLimits limits;
  limits.answerTimeout = 0.2;
  auto front = *HttpFront::start(handler, {.address = *resolveListenAddress("127.0.0.1:0"),
                                           .waitingThreads = 1,
                                           .limits = limits,
                                           .metrics = &metrics});
  RawClient client(front->port());
  client.send("GET /a HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_EQ(client.receiveAll(), "");  // hangs if it is not cut
  EXPECT_NE(metrics.text().find("meshfront_cut_total{phase=\"answer\"} 1\n"), std::string::npos);
  handler.goOn();
  front.reset();
  EXPECT_NE(metrics.text().find("meshfront_in_flight_bytes 0\n"), std::string::npos);
  EXPECT_NE(metrics.text().find("meshfront_requests_in_flight 0\n"), std::string::npos);
}

}  // namespace
}  // namespace meshfront
