// The service, or another proxy, that this proxy asks for what it lacks.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "proxy/fetch_memory.h"
#include "shared/result.h"

namespace meshfront {

struct UpstreamRequest {
  std::string target;                 // path and query
  bool query = false;                 // QUERY with `content`, else GET
  std::vector<uint8_t> content;       // octets of a bitstring
  std::string ifNoneMatch;            // an entity tag, or empty
  size_t maxBytes = size_t{1} << 30;  // a longer response is broken off: ErrorCode::tooLarge
  FetchMemory* memory = nullptr;      // counts the response's content; null: not counted
};

struct UpstreamResponse {
  unsigned status = 0;
  std::string etag;
  std::string cacheControl;
  std::chrono::seconds age{0};
  std::vector<uint8_t> content;  // untrusted, but as long as its Content-Length said
  FetchMemory::Share memory;     // for the content; more may be taken
};

// Of an Age field, untrusted; zero where it is none (RFC 9111 section 5.1).
[[nodiscard]] inline std::chrono::seconds ageOf(const std::string& field) {
  return std::chrono::seconds(std::clamp(std::atol(field.c_str()), 0L, long{INT32_MAX}));
}

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

  // Any status is a response. Errors: unavailable, no whole response came; timedOut, not in time;
  // tooLarge, more than was asked for; overloaded, no memory for it.
  [[nodiscard]] virtual Result<UpstreamResponse> send(const UpstreamRequest& request) = 0;
};

}  // namespace meshfront
