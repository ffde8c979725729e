// The HTTP server: HTTP/1.1 and 1.0 in front of an HttpHandler.
//
//   EventLoop (one a thread) -> Connection -> RequestHeadReader, ContentReader -> Exchange ->
//   HttpHandler -> responseHead -> one sendmsg, which does not copy the content
//
// A request is answered on the thread that serves its connection if that takes no wait. Otherwise
// a worker makes the answer and posts it back to that thread, which serves others meanwhile.
// Answers are sent in the order of the requests; what follows a request is not read before its
// answer has been handed to the kernel.
#pragma once

#include <cstdint>
#include <memory>

#include "shared/http/message.h"
#include "shared/http/metrics.h"
#include "shared/http/server/access_log.h"
#include "shared/http/server/listen_address.h"
#include "shared/http/server/server_limits.h"
#include "shared/result.h"

namespace meshfront {

class HttpFront {
 public:
  struct Options {
    ListenAddress address{};
    unsigned threads = 1;         // that serve connections, >= 1
    unsigned waitingThreads = 0;  // that may wait for answers; 0: the handler never waits
    size_t maxWaitingRequests = 4096;
    ServerLimits limits{};           // those of lines, fields and contents, connections, time and
                                     // memory; the rest is the handler's
    Metrics* metrics = nullptr;      // gets what FrontMetrics counts; must outlive the front
    AccessLog* accessLog = nullptr;  // likewise; none: no log
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
  // As asked for, or as many as the system grants descriptors for.
  [[nodiscard]] size_t maxConnections() const;

 private:
  struct Server;
  explicit HttpFront(std::unique_ptr<Server> server);
  std::unique_ptr<Server> server_;
};

}  // namespace meshfront
