#include "shared/http/server/server_run.h"

#include <spdlog/spdlog.h>

#include <cstdio>

#include "shared/http/server/http_front.h"

namespace meshfront {
namespace {

std::shared_ptr<AccessLog> openAccessLog(const ServerRun& run) {
  auto log = AccessLog::open(run.options.accessLog, run.options.accessLogFormat);
  if (!log) {
    spdlog::error("{}", log.error().message);
    return nullptr;
  }
  std::shared_ptr<AccessLog> shared = std::move(*log);
  run.metrics.countedElsewhere("meshfront_access_log_dropped_total",
                               "Lines of the access log that could not be written in time.",
                               [shared] { return shared->dropped(); });
  return shared;
}

void reopen(AccessLog& log) {
  if (const auto opened = log.reopen(); !opened) spdlog::error("{}", opened.error().message);
}

}  // namespace

int runServer(const ServerRun& run) {
  std::shared_ptr<AccessLog> log;
  if (!run.options.accessLog.empty()) {
    log = openAccessLog(run);
    if (!log) return kFailedStatus;
  }
  auto front = HttpFront::start(run.handler, {.address = run.options.address,
                                              .threads = run.options.threads,
                                              .waitingThreads = run.waitingThreads,
                                              .limits = run.options.limits,
                                              .metrics = &run.metrics,
                                              .accessLog = log.get()});
  if (!front) {
    spdlog::error("{}", front.error().message);
    return kFailedStatus;
  }
  if ((*front)->maxConnections() < run.options.limits.maxConnections)
    spdlog::warn("the system grants descriptors for {} connections only; raise LimitNOFILE",
                 (*front)->maxConnections());
  std::printf("listening on http://%s:%u\n", run.options.address.host.c_str(), (*front)->port());
  std::fflush(stdout);

  TerminationSignals::Meanwhile meanwhile = run.meanwhile;
  meanwhile.onHangUp = [&] {
    if (log) reopen(*log);
    if (run.meanwhile.onHangUp) run.meanwhile.onHangUp();
  };
  run.signals.wait(meanwhile);
  spdlog::info("ending");
  if (run.beforeEnd) run.beforeEnd();
  front->reset();
  return 0;
}

}  // namespace meshfront
