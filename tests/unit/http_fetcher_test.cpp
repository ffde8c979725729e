#include "shared/receiver/http_fetcher.h"

#include <gtest/gtest.h>

#include <future>

#include "tests/unit/scripted_server.h"

namespace meshfront {
namespace {

using std::chrono::milliseconds;

HttpFetcherOptions quick() {
  HttpFetcherOptions options;
  options.retry = {3, milliseconds(2), milliseconds(10)};
  return options;
}

FetchResponse fetch(HttpFetcher& fetcher, FetchRequest request) {
  std::promise<FetchResponse> promise;
  auto future = promise.get_future();
  (void)fetcher.send(std::move(request), [&promise](FetchResponse response) {
    promise.set_value(std::move(response));
  });
  return future.get();
}

FetchRequest get(std::string url) {
  FetchRequest request;
  request.url = std::move(url);
  return request;
}

std::string text(const FetchResponse& response) {
  return {response.body.begin(), response.body.end()};
}

TEST(HttpFetcher, GetsABodyAndHeadersAndCountsEveryOctet) {
  ScriptedServer server([](const std::string&) {
    return ScriptedServer::ok("records", "ETag: \"abc\"\r\nX-Twice: 1\r\nx-twice:  2 \r\n");
  });
  HttpFetcher fetcher(quick());
  const FetchResponse response = fetch(fetcher, get(server.origin() + "/v1/meshes/x"));
  EXPECT_EQ(response.status, 200U) << response.error.message;
  EXPECT_EQ(text(response), "records");
  EXPECT_EQ(response.headers.at("etag"), "\"abc\"");
  EXPECT_EQ(response.headers.at("x-twice"), "2");
  ASSERT_EQ(server.requests().size(), 1U);
  EXPECT_TRUE(server.requests()[0].starts_with("GET /v1/meshes/x HTTP/1.1\r\n"));
  EXPECT_EQ(server.requests()[0].find("Accept"), std::string::npos);
  EXPECT_EQ(response.traffic.attempts, 1U);
  EXPECT_EQ(response.traffic.bytesUp, server.bytesIn());
  EXPECT_EQ(response.traffic.bodyBytesDown, 7U);
  EXPECT_EQ(response.traffic.bytesDown(), server.bytesOut());
}

TEST(HttpFetcher, SendsAQueryWithItsContent) {
  ScriptedServer server([](const std::string&) { return ScriptedServer::ok("r"); });
  HttpFetcher fetcher(quick());
  FetchRequest request = get(server.origin() + "/splits");
  request.method = FetchRequest::Method::query;
  request.content.assign(5'000, 0);  // zero bytes are no ends of strings
  request.content[4'999] = 7;
  request.contentType = "application/octet-stream";
  request.bypassCaches = true;
  const FetchResponse response = fetch(fetcher, request);
  EXPECT_EQ(response.status, 200U) << response.error.message;
  ASSERT_EQ(server.requests().size(), 1U);
  const std::string seen = server.requests()[0];
  EXPECT_TRUE(seen.starts_with("QUERY /splits HTTP/1.1\r\n"));
  EXPECT_NE(seen.find("Content-Type: application/octet-stream\r\n"), std::string::npos);
  EXPECT_NE(seen.find("Content-Length: 5000\r\n"), std::string::npos);
  EXPECT_NE(seen.find("Cache-Control: no-cache\r\n"), std::string::npos);
  EXPECT_EQ(seen.find("Expect:"), std::string::npos);
  EXPECT_EQ(seen.back(), 7);
  EXPECT_EQ(response.traffic.bytesUp, server.bytesIn());

  // The slot's next request is a plain GET again.
  (void)fetch(fetcher, get(server.origin() + "/after"));
  EXPECT_TRUE(server.requests()[1].starts_with("GET /after"));
  EXPECT_EQ(server.requests()[1].find("Content-Length"), std::string::npos);
  EXPECT_EQ(server.connectionCount(), 1U);
}

TEST(HttpFetcher, TriesAgainAfterALostConnectionAndAfterServerErrors) {
  std::atomic<int> call{0};
  ScriptedServer server([&call](const std::string&) -> std::optional<std::string> {
    switch (call++) {
      case 0:
        return std::nullopt;
      case 1:
        return ScriptedServer::refusal("503 Service Unavailable", "Retry-After: 3600\r\n");
      default:
        return ScriptedServer::ok("here");
    }
  });
  HttpFetcher fetcher(quick());
  const FetchResponse response = fetch(fetcher, get(server.origin() + "/"));
  EXPECT_EQ(response.status, 200U) << response.error.message;
  EXPECT_EQ(text(response), "here");
  EXPECT_EQ(server.requests().size(), 3U);
  EXPECT_EQ(response.traffic.bytesUp, server.bytesIn());
  EXPECT_EQ(response.traffic.bytesDown(), server.bytesOut());
  EXPECT_EQ(response.headers.count("retry-after"), 0U);
}

TEST(HttpFetcher, GivesUpInTheEnd) {
  ScriptedServer server(
      [](const std::string&) { return ScriptedServer::refusal("500 Internal Server Error"); });
  HttpFetcher fetcher(quick());
  EXPECT_EQ(fetch(fetcher, get(server.origin() + "/")).status, 500U);
  EXPECT_EQ(server.requests().size(), 3U);
}

TEST(HttpFetcher, TakesARefusalForAnAnswer) {
  ScriptedServer server(
      [](const std::string&) { return ScriptedServer::refusal("404 Not Found"); });
  HttpFetcher fetcher(quick());
  EXPECT_EQ(fetch(fetcher, get(server.origin() + "/")).status, 404U);
  EXPECT_EQ(server.requests().size(), 1U);
}

TEST(HttpFetcher, FollowsNoRedirect) {
  ScriptedServer server([](const std::string&) {
    return ScriptedServer::refusal("302 Found", "Location: /elsewhere\r\n");
  });
  HttpFetcher fetcher(quick());
  EXPECT_EQ(fetch(fetcher, get(server.origin() + "/")).status, 302U);
  EXPECT_EQ(server.requests().size(), 1U);
}

TEST(HttpFetcher, SaysThatNobodyListens) {
  std::string origin;
  {
    const ScriptedServer closed([](const std::string&) { return std::nullopt; });
    origin = closed.origin();
  }
  HttpFetcher fetcher(quick());
  const FetchResponse response = fetch(fetcher, get(origin + "/v1/meshes/x"));
  EXPECT_EQ(response.status, 0U);
  EXPECT_EQ(response.error.code, ErrorCode::unavailable);
  EXPECT_NE(response.error.message.find(origin.substr(7)), std::string::npos);
  EXPECT_NE(response.error.message.find("is the service running"), std::string::npos);
  EXPECT_NE(response.error.message.find("3 attempts"), std::string::npos);
}

TEST(HttpFetcher, BreaksOffWhatIsTooLong) {
  ScriptedServer server([](const std::string& request) {
    if (request.find("/headers") != std::string::npos)
      return ScriptedServer::ok("", "X: " + std::string(50'000, 'x') + "\r\n");
    return ScriptedServer::ok(std::string(1'001, 'x'));
  });
  HttpFetcherOptions options = quick();
  options.maxHeaderBytes = 40'000;
  HttpFetcher fetcher(options);
  FetchRequest request = get(server.origin() + "/");
  request.maxBodyBytes = 1'001;
  EXPECT_EQ(fetch(fetcher, request).status, 200U);
  request.maxBodyBytes = 1'000;
  const FetchResponse body = fetch(fetcher, request);
  EXPECT_EQ(body.status, 0U);
  EXPECT_EQ(body.error.code, ErrorCode::tooLarge);
  EXPECT_TRUE(body.body.empty());
  const FetchResponse headers = fetch(fetcher, get(server.origin() + "/headers"));
  EXPECT_EQ(headers.status, 0U);
  EXPECT_EQ(headers.error.code, ErrorCode::tooLarge);
  EXPECT_EQ(server.requests().size(), 3U);  // no second try
}

TEST(HttpFetcher, NoticesATruncatedBody) {
  ScriptedServer server([](const std::string&) -> std::optional<std::string> {
    return "HTTP/1.1 200 OK\r\nConnection: close\r\nContent-Length: 10\r\n\r\nhalf";
  });
  HttpFetcherOptions options = quick();
  options.retry.attempts = 1;
  options.totalTimeout = milliseconds(300);  // the script leaves the connection open
  HttpFetcher fetcher(options);
  const FetchResponse response = fetch(fetcher, get(server.origin() + "/"));
  EXPECT_EQ(response.status, 0U);
  EXPECT_EQ(response.error.code, ErrorCode::unavailable);
}

TEST(HttpFetcher, LetsManyRequestsWaitForFewSlots) {
  ScriptedServer server([](const std::string& request) {
    return ScriptedServer::ok(request.substr(5, request.find(" HTTP") - 5));
  });
  HttpFetcherOptions options = quick();
  options.slots = 3;
  HttpFetcher fetcher(options);
  std::mutex mutex;
  std::vector<int> seen(100, 0);
  std::promise<void> all;
  int left = 100;
  for (int i = 0; i < 100; ++i) {
    (void)fetcher.send(get(server.origin() + "/" + std::to_string(i)),
                       [&, i](FetchResponse response) {
                         const std::lock_guard lock(mutex);
                         if (text(response) == std::to_string(i)) ++seen[static_cast<size_t>(i)];
                         if (--left == 0) all.set_value();
                       });
  }
  all.get_future().wait();
  EXPECT_EQ(seen, std::vector<int>(100, 1));
  EXPECT_LE(server.connectionCount(), 3U);
}

TEST(HttpFetcher, CallsNothingAfterCancelAndAfterItsEnd) {
  std::promise<void> blocked;
  std::promise<void> release;
  auto released = release.get_future().share();
  std::atomic<int> call{0};
  ScriptedServer server([&](const std::string&) {
    if (call++ == 0) blocked.set_value();
    released.wait();
    return ScriptedServer::ok("late");
  });
  std::atomic<int> completions{0};
  {
    HttpFetcherOptions options = quick();
    options.slots = 1;
    HttpFetcher fetcher(options);
    const auto count = [&completions](FetchResponse) { ++completions; };
    const FetchId running = fetcher.send(get(server.origin() + "/running"), count);
    const FetchId waiting = fetcher.send(get(server.origin() + "/waiting"), count);
    blocked.get_future().wait();
    fetcher.cancel(waiting);
    fetcher.cancel(running);
    fetcher.cancel(12'345);
    (void)fetcher.send(get(server.origin() + "/dies"), count);
  }
  release.set_value();
  EXPECT_EQ(completions, 0);
}

}  // namespace
}  // namespace meshfront
