// The server over real sockets, asked through the proxy's client.
#include "shared/http/server/http_front.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <thread>

#include "proxy/curl_upstream.h"

namespace meshfront {
namespace {

// Answers with what it was asked; "/wait..." only after open().
class EchoHandler final : public HttpHandler {
 public:
  std::optional<HttpResponse> answerAtOnce(const HttpRequest& request) override {
    if (request.target.starts_with("/wait")) return std::nullopt;
    return echo(request);
  }
  HttpResponse answer(const HttpRequest& request) override {
    ++waiting;
    gate_.get_future().wait();
    return echo(request);
  }
  HttpResponse overloaded(const HttpRequest&) override {
    HttpResponse response;
    response.status = 503;
    return response;
  }
  void open() { gate_.set_value(); }
  std::atomic<int> waiting{0};

 private:
  static HttpResponse echo(const HttpRequest& request) {
    HttpResponse response;
    response.status = request.contentTooLarge ? 413 : 200;
    std::string text(request.method);
    text.append(" ").append(request.target).append(" ").append(request.ifNoneMatch);
    text.append(" ").append(request.contentType).append(" ");
    text.append(request.content.begin(), request.content.end());
    response.content = HeldBytes::of(std::move(text));
    response.set("ETag", "\"echo\"");
    response.set("Cache-Control", "public, max-age=10");
    response.set("Age", "3");
    return response;
  }
  std::promise<void> gate_;
};

class HttpFrontTest : public ::testing::Test {
 protected:
  void start(HttpFront::Options options = {.waitingThreads = 1}) {
    options.address = *resolveListenAddress("127.0.0.1:0");
    auto front = HttpFront::start(handler_, options);
    ASSERT_TRUE(front) << front.error().message;
    front_ = std::move(*front);
    client_ = *CurlUpstream::make(
        {.url = "http://127.0.0.1:" + std::to_string(front_->port()) + "/", .via = "1.1 test"});
  }
  UpstreamResponse ask(const UpstreamRequest& request) {
    const auto response = client_->send(request);
    EXPECT_TRUE(response) << response.error().message;
    return response ? *response : UpstreamResponse{};
  }
  static std::string text(const UpstreamResponse& response) {
    return {response.content.begin(), response.content.end()};
  }

  EchoHandler handler_;
  std::unique_ptr<HttpFront> front_;
  std::unique_ptr<CurlUpstream> client_;
};

UpstreamRequest requestFor(const std::string& target) {
  UpstreamRequest request;
  request.target = target;
  return request;
}

TEST_F(HttpFrontTest, HandsOverTargetsUntouched) {
  start();
  const std::string target = "/a%41/../b?x=%20&y&";
  const UpstreamResponse response = ask(requestFor(target));
  EXPECT_EQ(response.status, 200U);
  EXPECT_EQ(text(response), "GET " + target + "   ");
  EXPECT_EQ(response.etag, "\"echo\"");
  EXPECT_EQ(response.cacheControl, "public, max-age=10");
  EXPECT_EQ(response.age, std::chrono::seconds(3));
}

TEST_F(HttpFrontTest, HandsOverLongTargets) {
  start();
  const std::string target = "/" + std::string(50000, 'a');
  EXPECT_EQ(text(ask(requestFor(target))), "GET " + target + "   ");
}

TEST_F(HttpFrontTest, HandsOverContentOfQueries) {
  start({.threads = 2, .waitingThreads = 1});
  UpstreamRequest request = requestFor("/q");
  request.query = true;
  request.ifNoneMatch = "\"a\"";
  for (const size_t size : {size_t{0}, size_t{1}, size_t{100000}, size_t{1} << 20}) {
    request.content.assign(size, 'z');
    EXPECT_EQ(text(ask(request)),
              "QUERY /q \"a\" application/octet-stream " + std::string(size, 'z'));
  }
  request.content.push_back('z');  // one octet more than allowed
  EXPECT_EQ(ask(request).status, 413U);
  request.content.resize(size_t{5} << 20);
  EXPECT_EQ(ask(request).status, 413U);
}

TEST_F(HttpFrontTest, WaitingRequestsDoNotBlockOthers) {
  start({.threads = 1, .waitingThreads = 2});
  auto first = std::async([&] { return text(ask(requestFor("/wait/1"))); });
  while (handler_.waiting == 0) std::this_thread::yield();
  EXPECT_EQ(text(ask(requestFor("/now"))), "GET /now   ");  // hangs if it is blocked
  handler_.open();
  EXPECT_EQ(first.get(), "GET /wait/1   ");
}

TEST_F(HttpFrontTest, SaysWhenTooManyWait) {
  start({.threads = 1, .waitingThreads = 1, .maxWaitingRequests = 0});
  EXPECT_EQ(ask(requestFor("/wait")).status, 503U);
}

TEST_F(HttpFrontTest, FinishesWaitingAnswersWhenItEnds) {
  start({.threads = 1, .waitingThreads = 1});
  auto answer = std::async([&] { return text(ask(requestFor("/wait"))); });
  while (handler_.waiting == 0) std::this_thread::yield();
  auto end = std::async([&] { front_.reset(); });
  handler_.open();
  end.get();
  EXPECT_EQ(answer.get(), "GET /wait   ");
}

// A worker posts its answer while the loops are about to end; which comes first depends on the
// moment.
TEST_F(HttpFrontTest, EndsAtAnyMomentOfAnAnswer) {
  for (int i = 0; i < 60; ++i) {
    EchoHandler handler;
    HttpFront::Options options{.threads = 1, .waitingThreads = 1};
    options.address = *resolveListenAddress("127.0.0.1:0");
    auto front = *HttpFront::start(handler, options);
    const auto client = *CurlUpstream::make(
        {.url = "http://127.0.0.1:" + std::to_string(front->port()) + "/", .via = "1.1 test"});
    auto answer = std::async([&] { return client->send(requestFor("/wait")); });
    while (handler.waiting == 0) std::this_thread::yield();
    auto end = std::async([&] { front.reset(); });
    std::this_thread::sleep_for(std::chrono::microseconds(20 * (i % 20)));
    handler.open();
    end.get();
    const auto response = answer.get();
    EXPECT_TRUE(response && response->status == 200) << i;
  }
}

TEST_F(HttpFrontTest, TheClientRefusesResponsesThatAreTooLong) {
  start();
  UpstreamRequest request = requestFor("/" + std::string(1000, 'a'));
  request.maxBytes = 100;
  const auto response = client_->send(request);
  ASSERT_FALSE(response);
  EXPECT_EQ(response.error().code, ErrorCode::tooLarge);
}

TEST_F(HttpFrontTest, TheClientReportsAnAbsentServer) {
  start();
  front_.reset();
  const auto response = client_->send(requestFor("/"));
  ASSERT_FALSE(response);
  EXPECT_EQ(response.error().code, ErrorCode::unavailable);
}

TEST(CurlUpstream, RefusesOtherUrls) {
  for (const char* url :
       {"", "http://", "ftp://a", "file:///etc/passwd", "a:80", "http://a?x", "http://a b", "HTTP"})
    EXPECT_FALSE(CurlUpstream::make({.url = url, .via = {}})) << url;
}

}  // namespace
}  // namespace meshfront
