// Serves until the program is told to end: what the programs do once their handler is ready.
#pragma once

#include <functional>

#include "shared/http/message.h"
#include "shared/http/metrics.h"
#include "shared/http/server/server_options.h"
#include "shared/http/server/termination_signals.h"

namespace meshfront {

struct ServerRun {
  HttpHandler& handler;
  Metrics& metrics;
  const ServerOptions& options;
  const TerminationSignals& signals;
  unsigned waitingThreads = 0;                // as in HttpFront::Options
  TerminationSignals::Meanwhile meanwhile{};  // SIGHUP opens the access log anew besides
  std::function<void()> beforeEnd{};          // called once no more is accepted to wait for
};

// Listens, prints "listening on http://HOST:PORT" to standard output, waits for SIGTERM or SIGINT,
// and ends what is under way. The exit status; what went wrong is logged.
[[nodiscard]] int runServer(const ServerRun& run);

}  // namespace meshfront
