// An upstream over HTTP/1.1 by libcurl, with connections kept open between requests.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "proxy/upstream.h"

namespace meshfront {

class CurlUpstream final : public Upstream {
 public:
  struct Options {
    std::string url;  // http://HOST:PORT or https://HOST, a path prefix allowed
    std::chrono::milliseconds connectTimeout{2000};
    std::chrono::milliseconds timeout{30000};  // of a whole request
    std::string via;                           // value of the Via field sent along
  };
  // An error where the URL is none of http or https.
  [[nodiscard]] static Result<std::unique_ptr<CurlUpstream>> make(Options options);
  ~CurlUpstream() override;

  [[nodiscard]] Result<UpstreamResponse> send(const UpstreamRequest& request) override;
  // The Via field of the last response: which proxies stand in front of the origin. Empty: none, or
  // one that is no list of plain words.
  [[nodiscard]] std::string via() const {
    const auto via = via_.load();
    return via ? *via : std::string();
  }
  // Requests under way fail soon, later ones at once.
  void stop() { stopping_ = true; }

 private:
  struct Handle;
  explicit CurlUpstream(Options options);
  [[nodiscard]] std::unique_ptr<Handle> take();
  void giveBack(std::unique_ptr<Handle> handle);

  void noteVia(const std::string& via);

  const Options options_;
  std::atomic<bool> stopping_{false};
  std::atomic<std::shared_ptr<const std::string>> via_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Handle>> idle_;  // each with its open connection
};

}  // namespace meshfront
