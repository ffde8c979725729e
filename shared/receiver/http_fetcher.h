// HTTP over libcurl in a thread of its own. Thread-safe; one fetcher serves any number of
// receivers.
//
// Each request in progress owns one of a fixed number of slots (a curl handle and its buffers);
// further ones wait in order. Connections are kept and shared between slots. Lost connections and
// the statuses 408, 429, 500, 502, 503 and 504 are tried again (RetryPolicy) before the completion
// is called. Redirects are not followed. Proxies come from the environment as in curl, but never
// for loopback addresses.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "shared/receiver/retry_schedule.h"
#include "shared/receiver/transport.h"

namespace meshfront {

struct HttpFetcherOptions {
  unsigned slots = 8;                               // requests in progress, >= 1
  std::chrono::milliseconds connectTimeout{5'000};  // each attempt
  std::chrono::milliseconds stallTimeout{15'000};   // an attempt in which no byte moves that long
  std::chrono::milliseconds totalTimeout{120'000};  // each attempt
  size_t maxHeaderBytes = 64 << 10;                 // of an answer
  RetryPolicy retry;
  std::string userAgent = "meshfront";
};

class HttpFetcher final : public Transport {
 public:
  explicit HttpFetcher(HttpFetcherOptions options = {});
  // Breaks off what is in progress, calls no completion any more, joins the thread.
  ~HttpFetcher() override;
  HttpFetcher(const HttpFetcher&) = delete;
  HttpFetcher& operator=(const HttpFetcher&) = delete;

  [[nodiscard]] FetchId send(FetchRequest request, Completion completion) override;
  void cancel(FetchId id) override;

 private:
  class Loop;
  std::unique_ptr<Loop> loop_;
};

}  // namespace meshfront
