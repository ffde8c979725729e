// meshfront-load: many simulated receivers against one service, proxy or cache.
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <iostream>
#include <thread>
#include <utility>

#include "load/load_options.h"
#include "load/load_report.h"
#include "load/mesh_check.h"
#include "shared/program/interrupt.h"
#include "shared/receiver/http_fetcher.h"

namespace meshfront {
namespace {

constexpr unsigned kFilesBesideConnections = 64;

// As many open files as the system lets this process have.
bool allowConnections(unsigned connections) {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return true;
  const rlim_t needed = connections + kFilesBesideConnections;
  if (limit.rlim_cur >= needed) return true;
  limit.rlim_cur = std::min<rlim_t>(needed, limit.rlim_max);
  return setrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur >= needed;
}

uint64_t peakMemory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

class Load {
 public:
  explicit Load(const LoadOptions& options)
      : options_(options), fetcher_(fetcherOptions(options)), transport_(fetcher_) {}

  Result<LoadReport> run(ViewChoice views) {
    LoadReport report;
    report.options = &options_;
    if (Result<void> there = checkMesh(options_.run.url, fetcher_); !there)
      return tl::unexpected(there.error());
    if (Result<void> read = readMetrics(report, &MetricsSpan::before); !read)
      return tl::unexpected(read.error());
    LoadRun run(options_.run, std::move(views), transport_);
    run.start();
    watch(run);
    report.result = run.end();
    report.transport = transport_.counts();
    report.peakMemory = peakMemory();
    if (Result<void> read = readMetrics(report, &MetricsSpan::after); !read) {
      // What receivers saw is told all the same.
      std::cerr << "meshfront-load: " << read.error().message << '\n';
      report.origin.reset();
      report.proxy.reset();
    }
    return report;
  }

 private:
  static HttpFetcherOptions fetcherOptions(const LoadOptions& options) {
    HttpFetcherOptions result;
    result.slots = options.connections;
    result.userAgent = "meshfront-load";
    return result;
  }

  // A line a second until all is done, time is up or a signal came.
  void watch(const LoadRun& run) {
    const bool talking = options_.verbose || isatty(STDERR_FILENO) == 1;
    TransportCounts last;
    auto next = std::chrono::steady_clock::now() + std::chrono::seconds(1);
    while (!run.finished() && !interrupted()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      if (!talking || std::chrono::steady_clock::now() < next) continue;
      next += std::chrono::seconds(1);
      TransportCounts now = transport_.counts();
      std::cerr << progressLine(run.progress(), now, last) << std::endl;
      last = std::move(now);
    }
  }

  Result<void> readMetrics(LoadReport& report, MetricsPage MetricsSpan::*when) {
    const auto read = [&](const std::string& origin, std::optional<MetricsSpan>& span) {
      if (origin.empty()) return Result<void>();
      auto page = MetricsPage::fetch(origin, fetcher_);
      if (!page) return Result<void>(tl::unexpected(page.error()));
      if (!span) span.emplace();
      (*span).*when = std::move(*page);
      return Result<void>();
    };
    if (Result<void> done = read(options_.originMetrics, report.origin); !done) return done;
    return read(options_.proxyMetrics, report.proxy);
  }

  const LoadOptions& options_;
  HttpFetcher fetcher_;
  MeasuredTransport transport_;
};

int runLoad(const LoadOptions& options) {
  auto views = ViewChoice::read(options.views, options.zipfExponent, options.seed);
  if (!views) {
    std::cerr << "meshfront-load: " << views.error().message << '\n';
    return 2;
  }
  if (!allowConnections(options.connections)) {
    std::cerr << "meshfront-load: " << options.connections
              << " connections are more than this process may open (ulimit -n); use fewer "
                 "--connections\n";
    return 2;
  }
  const Result<LoadReport> report = Load(options).run(std::move(*views));
  if (!report) {
    std::cerr << "meshfront-load: " << report.error().message << '\n';
    return 1;
  }
  std::cout << (options.json ? toJson(*report) + "\n" : toText(*report)) << std::flush;
  return report->result.failed > 0 ? 1 : 0;
}

}  // namespace
}  // namespace meshfront

int main(int argc, char** argv) {
  const meshfront::ParsedLoadOptions parsed = meshfront::parseLoadOptions(argc, argv);
  if (parsed.exitCode) return *parsed.exitCode;
  meshfront::catchInterrupts();
  return meshfront::runLoad(parsed.options);
}
