// An upstream in the same process: requests go to an HttpHandler, on whose answers a test may play
// tricks.
#pragma once

#include <algorithm>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "proxy/upstream.h"
#include "shared/http/message.h"

namespace meshfront {

class ScriptedUpstream final : public Upstream {
 public:
  // Sees each response before the caller does, and may change it, make it an error, or wait.
  using Trick = std::function<void(const UpstreamRequest&, Result<UpstreamResponse>&)>;

  explicit ScriptedUpstream(HttpHandler& handler) : handler_(handler) {}

  void play(Trick trick) {
    const std::scoped_lock lock(mutex_);
    trick_ = std::move(trick);
  }
  // Requests so far whose target contains `part`.
  [[nodiscard]] size_t count(const std::string& part) const {
    const std::scoped_lock lock(mutex_);
    return static_cast<size_t>(
        std::count_if(requests_.begin(), requests_.end(), [&](const UpstreamRequest& request) {
          return request.target.find(part) != std::string::npos;
        }));
  }
  [[nodiscard]] std::vector<UpstreamRequest> requests() const {
    const std::scoped_lock lock(mutex_);
    return requests_;
  }

  [[nodiscard]] Result<UpstreamResponse> send(const UpstreamRequest& request) override {
    Trick trick;
    {
      const std::scoped_lock lock(mutex_);
      requests_.push_back(request);
      trick = trick_;
    }
    HttpRequest asked;
    asked.method = request.query ? "QUERY" : "GET";
    asked.target = request.target;
    asked.ifNoneMatch = request.ifNoneMatch;
    asked.contentType = "application/octet-stream";
    asked.content = request.content;
    const HttpResponse answer = handler_.answer(asked);
    UpstreamResponse response;
    response.status = answer.status;
    for (const auto& [name, value] : answer.headers) {
      if (std::string_view(name) == "ETag") response.etag = value;
      if (std::string_view(name) == "Cache-Control") response.cacheControl = value;
    }
    const auto bytes = answer.content.bytes();
    if (answer.status != 304) response.content.assign(bytes.begin(), bytes.end());
    Result<UpstreamResponse> result = std::move(response);
    if (trick) trick(request, result);
    return result;
  }

 private:
  HttpHandler& handler_;
  mutable std::mutex mutex_;
  Trick trick_;
  std::vector<UpstreamRequest> requests_;
};

}  // namespace meshfront
