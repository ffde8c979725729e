// meshfront-proxy: the same interface as the service, from a cache of records over another service.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "proxy/cached_catalogue.h"
#include "proxy/curl_upstream.h"
#include "proxy/retrying_upstream.h"
#include "proxy/timed_upstream.h"
#include "shared/http/record_service.h"
#include "shared/http/server/server_options.h"
#include "shared/http/server/server_run.h"
#include "shared/http/server/termination_signals.h"

namespace {

using namespace meshfront;

constexpr const char* kVia = "1.1 meshfront";

struct Options {
  ServerOptions server{.listen = "127.0.0.1:8081"};
  std::string upstream;
  uint64_t cacheSize = uint64_t{256} << 20;
  uint64_t fetchMemory = uint64_t{512} << 20;
  unsigned waitingThreads = 64;
  double patience = 5;
  double timeout = 30;
};

std::optional<int> parse(int argc, char** argv, Options& options) {
  CLI::App app("Caches the records of a meshfront service, or of another proxy.",
               "meshfront-proxy");
  app.add_option("--upstream", options.upstream, "http://HOST:PORT of the service")->required();
  app.add_option("--cache-size", options.cacheSize,
                 "memory for records, chunks, base meshes and metadata, for example 256MiB")
      ->transform(CLI::AsSizeValue(false))
      ->default_str("256MiB");
  app.add_option("--fetch-memory", options.fetchMemory,
                 "memory for answers of the upstream until they are put together; a request beyond "
                 "it gets 503")
      ->transform(CLI::AsSizeValue(false))
      ->default_str("512MiB");
  app.add_option("--waiting-threads", options.waitingThreads,
                 "requests that may wait for the upstream at a time")
      ->check(CLI::Range(1U, 1024U))
      ->capture_default_str();
  app.add_option("--patience", options.patience,
                 "seconds for which connecting to the upstream is tried again")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  app.add_option("--timeout", options.timeout, "seconds that an upstream request may take")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  addServerOptions(app, options.server);
  return parseServerOptions(app, argc, argv, options.server);
}

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<int64_t>(seconds * 1000));
}

int serve(const Options& options) {
  const TerminationSignals signals;
  const auto connection = CurlUpstream::make(
      {.url = options.upstream, .timeout = milliseconds(options.timeout), .via = kVia});
  if (!connection) {
    std::fprintf(stderr, "%s\n", connection.error().message.c_str());
    return kUsageStatus;
  }
  Metrics metrics;
  TimedUpstream timed(**connection, metrics);
  RetryingUpstream upstream(timed, {.patience = milliseconds(options.patience)});
  ProxyCounters counters(metrics);
  MemoryBudget budget(options.cacheSize);
  metrics.gauge("meshfront_cache_bytes", "Memory that cached records and documents take.",
                [&] { return budget.bytes(); });
  metrics.countedElsewhere("meshfront_cache_evicted_bytes_total",
                           "Bytes of cached records and documents given up for others.",
                           [&] { return budget.releasedBytes(); });
  FetchMemory memory(options.fetchMemory);
  metrics.gauge("meshfront_fetch_memory_bytes",
                "Memory that answers of the upstream take until they are put together.",
                [&] { return memory.bytes(); });
  DocumentCache documents(upstream, budget, memory, counters, {});
  CachedCatalogue catalogue({upstream, documents, budget, memory, counters});
  RecordService::Options serving = serviceOptions(options.server.limits, kVia);
  serving.viaBefore = [&] { return (*connection)->via(); };
  RecordService service(catalogue, metrics, std::move(serving));
  return runServer({.handler = service,
                    .metrics = metrics,
                    .options = options.server,
                    .signals = signals,
                    .waitingThreads = options.waitingThreads,
                    .beforeEnd = [&] {
                      (*connection)->stop();
                      upstream.stop();
                    }});
}

}  // namespace

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("meshfront-proxy"));
  Options options;
  const auto status = parse(argc, argv, options);
  return status ? *status : serve(options);
}
