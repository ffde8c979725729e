// The service, or another proxy, that this proxy asks for what it lacks.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "shared/result.h"

namespace meshfront {

struct UpstreamRequest {
  std::string target;                 // path and query
  bool query = false;                 // QUERY with `content`, else GET
  std::vector<uint8_t> content;       // octets of a bitstring
  std::string ifNoneMatch;            // an entity tag, or empty
  size_t maxBytes = size_t{1} << 30;  // a longer response is refused
};

struct UpstreamResponse {
  unsigned status = 0;
  std::string etag;
  std::string cacheControl;
  std::chrono::seconds age{0};
  std::vector<uint8_t> content;  // untrusted, but as long as its Content-Length said
};

// No answer came; another time one may.
inline bool isAway(const Error& error) {
  return error.code == ErrorCode::unavailable || error.code == ErrorCode::timedOut;
}

// Thread-safe.
class Upstream {
 public:
  Upstream() = default;
  virtual ~Upstream() = default;
  Upstream(const Upstream&) = delete;
  Upstream& operator=(const Upstream&) = delete;

  // Any status is a response. unavailable: no whole response came; timedOut: not in time.
  [[nodiscard]] virtual Result<UpstreamResponse> send(const UpstreamRequest& request) = 0;
};

}  // namespace meshfront
