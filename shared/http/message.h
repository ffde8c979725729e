// Requests and responses as the record service sees them, apart from any HTTP library.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/store/held_bytes.h"

namespace meshfront {

// All of it untrusted. Views live as long as the call that gets them.
struct HttpRequest {
  std::string_view method;
  std::string_view target;       // as received: path and query, nothing unescaped
  std::string_view ifNoneMatch;  // lines joined by commas; empty: none
  std::string_view contentType;
  std::span<const uint8_t> content;
  bool contentTooLarge = false;  // then `content` is empty
};

struct HttpResponse {
  unsigned status = 200;
  std::vector<std::pair<const char*, std::string>> headers;  // without Content-Length and Date
  HeldBytes content;  // of a HEAD answer too: gives its length

  void set(const char* name, std::string value) { headers.emplace_back(name, std::move(value)); }
};

class HttpHandler {
 public:
  HttpHandler() = default;
  virtual ~HttpHandler() = default;
  HttpHandler(const HttpHandler&) = delete;
  HttpHandler& operator=(const HttpHandler&) = delete;

  // Called on the thread that serves connections: nothing where answering takes a wait.
  [[nodiscard]] virtual std::optional<HttpResponse> answerAtOnce(const HttpRequest& request) = 0;
  // Called on a thread that may wait.
  [[nodiscard]] virtual HttpResponse answer(const HttpRequest& request) = 0;
  // When no thread is free to wait for the answer.
  [[nodiscard]] virtual HttpResponse overloaded(const HttpRequest& request) = 0;
};

}  // namespace meshfront
