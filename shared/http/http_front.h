// The HTTP server: libmicrohttpd with epoll threads in front of an HttpHandler.
//
// A request is answered on the thread that serves its connection if that takes no wait. Otherwise
// the connection is suspended, a worker computes the answer and resumes the connection; others on
// the thread go on meanwhile.
#pragma once

#include <cstdint>
#include <memory>

#include "shared/http/listen_address.h"
#include "shared/http/message.h"
#include "shared/result.h"

namespace meshfront {

class HttpFront {
 public:
  struct Options {
    ListenAddress address{};
    unsigned threads = 1;         // that serve connections, >= 1
    unsigned waitingThreads = 0;  // that may wait for answers; 0: the handler never waits
    size_t maxWaitingRequests = 4096;
    size_t maxContentBytes = size_t{1} << 20;  // of a request; more is marked as too large
    unsigned idleSeconds = 75;                 // after which a silent connection is closed
  };
  // Listens when it returns. `handler` must outlive the front.
  [[nodiscard]] static Result<std::unique_ptr<HttpFront>> start(HttpHandler& handler,
                                                                const Options& options);
  // Accepts no more, gives what is under way 3 seconds to be answered and sent, then closes all
  // connections.
  ~HttpFront();
  HttpFront(const HttpFront&) = delete;
  HttpFront& operator=(const HttpFront&) = delete;

  [[nodiscard]] uint16_t port() const;

 private:
  struct Server;
  explicit HttpFront(std::unique_ptr<Server> server);
  std::unique_ptr<Server> server_;
};

}  // namespace meshfront
