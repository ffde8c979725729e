// What the receiver needs of HTTP: requests that are answered later, on another thread. The real
// one is HttpFetcher; tests script their own.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "shared/result.h"

namespace meshfront {

struct FetchRequest {
  enum class Method { get, query };  // QUERY: RFC 10008, safe and idempotent as GET is
  Method method = Method::get;
  std::string url;
  std::vector<uint8_t> content;   // of a QUERY
  std::string contentType;        // of a QUERY
  size_t maxBodyBytes = 1 << 20;  // a longer answer is broken off
  bool bypassCaches = false;      // sends Cache-Control: no-cache
  // Grows by the octets of the answer while they come in, if given: tells a slow answer from none.
  std::shared_ptr<std::atomic<uint64_t>> received;
};

// Octets of HTTP/1.1 messages, over all attempts; TCP, IP and TLS are not counted.
struct Traffic {
  uint64_t attempts = 0;         // requests sent, with repeated ones
  uint64_t bytesUp = 0;          // request lines, headers, content
  uint64_t headerBytesDown = 0;  // status lines and headers
  uint64_t bodyBytesDown = 0;
  [[nodiscard]] uint64_t bytesDown() const { return headerBytesDown + bodyBytesDown; }
  Traffic& operator+=(const Traffic& other) {
    attempts += other.attempts;
    bytesUp += other.bytesUp;
    headerBytesDown += other.headerBytesDown;
    bodyBytesDown += other.bodyBytesDown;
    return *this;
  }
};

// Of the last attempt, as the transport saw it; all zero where it does not tell.
struct FetchTiming {
  using Clock = std::chrono::steady_clock;
  Clock::time_point sent;       // with a connection open
  Clock::time_point firstByte;  // of the answer
  Clock::time_point done;
  [[nodiscard]] bool known() const { return sent != Clock::time_point() && firstByte >= sent; }
};

struct FetchResponse {
  unsigned status = 0;  // 0: no answer, and `error` says why
  Error error;
  std::vector<uint8_t> body;
  std::map<std::string, std::string, std::less<>> headers;  // names in lower case
  Traffic traffic;
  FetchTiming timing;
};

using FetchId = uint64_t;

class Transport {
 public:
  // Called once, on a thread of the transport; must not throw and should be quick.
  using Completion = std::function<void(FetchResponse)>;

  virtual ~Transport() = default;
  [[nodiscard]] virtual FetchId send(FetchRequest request, Completion completion) = 0;
  // The completion is dropped, unless it is being called just now. Unknown ids are ignored.
  virtual void cancel(FetchId id) = 0;
};

}  // namespace meshfront
