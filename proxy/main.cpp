// meshfront-proxy: the same interface as the service, from a cache of records over another service.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <thread>

#include "proxy/cached_catalogue.h"
#include "proxy/curl_upstream.h"
#include "proxy/retrying_upstream.h"
#include "shared/http/http_front.h"
#include "shared/http/record_service.h"
#include "shared/http/termination_signals.h"

namespace {

constexpr int kFailed = 1;
constexpr int kUsage = 2;
constexpr const char* kVia = "1.1 meshfront";

struct Options {
  std::string upstream;
  std::string listen = "127.0.0.1:8081";
  uint64_t cacheSize = uint64_t{256} << 20;
  unsigned threads = std::max(1U, std::thread::hardware_concurrency());
  unsigned waitingThreads = 64;
  double patience = 5;
  double timeout = 30;
};

int parse(int argc, char** argv, Options& options, bool& done) {
  CLI::App app("Caches the records of a meshfront service, or of another proxy.",
               "meshfront-proxy");
  app.add_option("--upstream", options.upstream, "http://HOST:PORT of the service")->required();
  app.add_option("--listen", options.listen, "HOST:PORT; port 0 takes a free one")
      ->capture_default_str();
  app.add_option("--cache-size", options.cacheSize,
                 "memory for records, chunks, base meshes and metadata, for example 256MiB")
      ->transform(CLI::AsSizeValue(false))
      ->default_str("256MiB");
  app.add_option("--threads", options.threads, "threads that serve connections")
      ->check(CLI::Range(1U, 256U))
      ->capture_default_str();
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
  done = true;
  try {
    app.parse(argc, argv);
    done = false;
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kUsage;
  }
}

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<int64_t>(seconds * 1000));
}

int serve(const Options& options) {
  using namespace meshfront;
  const TerminationSignals signals;
  const auto address = resolveListenAddress(options.listen);
  if (!address) {
    std::fprintf(stderr, "%s\n", address.error().message.c_str());
    return kUsage;
  }
  const auto connection = CurlUpstream::make(
      {.url = options.upstream, .timeout = milliseconds(options.timeout), .via = kVia});
  if (!connection) {
    std::fprintf(stderr, "%s\n", connection.error().message.c_str());
    return kUsage;
  }
  RetryingUpstream upstream(**connection, {.patience = milliseconds(options.patience)});
  Metrics metrics;
  ProxyCounters counters(metrics);
  MemoryBudget budget(options.cacheSize);
  metrics.gauge("meshfront_cache_bytes", "Memory that cached records and documents take.",
                [&] { return budget.bytes(); });
  DocumentCache documents(upstream, budget, counters);
  CachedCatalogue catalogue({upstream, documents, budget, counters});
  RecordService service(catalogue, metrics, {.limits = {}, .via = kVia});
  auto front = HttpFront::start(
      service,
      {.address = *address, .threads = options.threads, .waitingThreads = options.waitingThreads});
  if (!front) {
    spdlog::error("{}", front.error().message);
    return kFailed;
  }
  std::printf("listening on http://%s:%u\n", address->host.c_str(), (*front)->port());
  std::fflush(stdout);
  signals.wait();
  spdlog::info("ending");
  (*connection)->stop();
  upstream.stop();
  front->reset();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("meshfront-proxy"));
  Options options;
  bool done = false;
  const int status = parse(argc, argv, options, done);
  return done ? status : serve(options);
}
