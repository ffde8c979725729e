// meshfront-serve: the HTTP interface over a folder of packs.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <thread>

#include "service/pack_catalogue.h"
#include "shared/http/http_front.h"
#include "shared/http/record_service.h"
#include "shared/http/termination_signals.h"

namespace {

struct Options {
  std::string packs;
  std::string listen = "127.0.0.1:8080";
  uint64_t indexBudget = uint64_t{256} << 20;
  unsigned threads = std::max(1U, std::thread::hardware_concurrency());
};

constexpr int kFailed = 1;
constexpr int kUsage = 2;

int parse(int argc, char** argv, Options& options, bool& done) {
  CLI::App app("Serves packs over HTTP.", "meshfront-serve");
  app.add_option("--packs", options.packs, "folder with *.pack files")->required();
  app.add_option("--listen", options.listen, "HOST:PORT; port 0 takes a free one")
      ->capture_default_str();
  app.add_option("--index-budget", options.indexBudget,
                 "memory for the index of records, for example 256MiB")
      ->transform(CLI::AsSizeValue(false))
      ->default_str("256MiB");
  app.add_option("--threads", options.threads, "threads that serve connections")
      ->check(CLI::Range(1U, 256U))
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

int serve(const Options& options) {
  using namespace meshfront;
  const TerminationSignals signals;
  const auto address = resolveListenAddress(options.listen);
  if (!address) {
    std::fprintf(stderr, "%s\n", address.error().message.c_str());
    return kUsage;
  }
  const auto budget = std::make_shared<MemoryBudget>(options.indexBudget);
  const auto catalogue = PackCatalogue::read(options.packs, budget);
  if (!catalogue) {
    spdlog::error("{}", catalogue.error().message);
    return kFailed;
  }
  if ((*catalogue)->size() == 0) spdlog::warn("no pack in {}: nothing to serve", options.packs);

  Metrics metrics;
  metrics.gauge("meshfront_index_bytes", "Memory that the index of records takes.",
                [&] { return budget->bytes(); });
  metrics.gauge("meshfront_meshes", "Meshes in the catalogue.",
                [&] { return (*catalogue)->size(); });
  RecordService service(**catalogue, metrics, {});
  const auto front = HttpFront::start(service, {.address = *address, .threads = options.threads});
  if (!front) {
    spdlog::error("{}", front.error().message);
    return kFailed;
  }
  std::printf("listening on http://%s:%u\n", address->host.c_str(), (*front)->port());
  std::fflush(stdout);
  signals.wait();
  spdlog::info("ending");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("meshfront-serve"));
  Options options;
  bool done = false;
  const int status = parse(argc, argv, options, done);
  return done ? status : serve(options);
}
