// meshfront-serve: the HTTP interface over a folder of packs.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "service/pack_catalogue.h"
#include "shared/http/record_service.h"
#include "shared/http/server/server_options.h"
#include "shared/http/server/server_run.h"
#include "shared/http/server/termination_signals.h"

namespace {

using namespace meshfront;

struct Options {
  ServerOptions server{.listen = "127.0.0.1:8080"};
  std::string packs;
  uint64_t indexBudget = uint64_t{256} << 20;
  double rescan = 2;
  double grace = 60;
};

std::optional<int> parse(int argc, char** argv, Options& options) {
  CLI::App app("Serves packs over HTTP.", "meshfront-serve");
  app.add_option("--packs", options.packs, "folder with *.pack files")->required();
  app.add_option("--rescan", options.rescan,
                 "seconds between two looks at the folder, 0: only on SIGHUP")
      ->check(CLI::Range(0.0, 86400.0))
      ->capture_default_str();
  app.add_option("--grace", options.grace,
                 "seconds for which a replaced or removed revision stays answerable")
      ->check(CLI::Range(0.0, 86400.0))
      ->capture_default_str();
  app.add_option("--index-budget", options.indexBudget,
                 "memory for the index of records, for example 256MiB")
      ->transform(CLI::AsSizeValue(false))
      ->default_str("256MiB");
  addServerOptions(app, options.server);
  return parseServerOptions(app, argc, argv, options.server);
}

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<int64_t>(seconds * 1000));
}

void showCatalogue(Metrics& metrics, const PackCatalogue& catalogue) {
  metrics.gauge("meshfront_meshes", "Meshes in the catalogue.",
                [&] { return catalogue.statistics().meshes; });
  metrics.gauge("meshfront_packs_broken", "Pack files that cannot be served as they are now.",
                [&] { return catalogue.statistics().brokenFiles; });
  metrics.gauge("meshfront_revisions_retired",
                "Replaced or removed revisions that are still answerable.",
                [&] { return catalogue.statistics().retired; });
  metrics.countedElsewhere("meshfront_packs_loaded_total",
                           "Packs taken up, those at the start included.",
                           [&] { return catalogue.statistics().loads; });
  metrics.countedElsewhere("meshfront_pack_failures_total",
                           "Pack files, new or changed, that could not be taken up.",
                           [&] { return catalogue.statistics().failures; });
  metrics.countedElsewhere("meshfront_lost_scans_total",
                           "Times that the folder of packs could not be read.",
                           [&] { return catalogue.statistics().lostScans; });
}

void showIndexes(Metrics& metrics, const MemoryBudget& budget, const IndexStatistics& indexes) {
  metrics.gauge("meshfront_index_bytes", "Memory that the index of records takes.",
                [&] { return budget.bytes(); });
  metrics.countedElsewhere("meshfront_index_evicted_bytes_total",
                           "Bytes of the index given up to keep within its budget.",
                           [&] { return budget.releasedBytes(); });
  metrics.countedElsewhere("meshfront_index_hits_total",
                           "Records of answers that were found indexed.",
                           [&] { return indexes.hits.load(); });
  metrics.countedElsewhere("meshfront_index_misses_total",
                           "Records of answers that were looked for in their chunk.",
                           [&] { return indexes.misses.load(); });
  metrics.countedElsewhere("meshfront_index_chunks_total",
                           "Chunks decoded to be indexed, those forgotten before included.",
                           [&] { return indexes.chunksIndexed.load(); });
  metrics.countedElsewhere("meshfront_index_evicted_chunks_total",
                           "Chunks forgotten to keep the index within its budget.",
                           [&] { return indexes.chunksForgotten.load(); });
}

int serve(const Options& options) {
  const TerminationSignals signals;
  const auto budget = std::make_shared<MemoryBudget>(options.indexBudget);
  const auto indexes = std::make_shared<IndexStatistics>();
  const auto opened = PackCatalogue::read(
      options.packs, budget, {.grace = milliseconds(options.grace), .indexes = indexes});
  if (!opened) {
    spdlog::error("{}", opened.error().message);
    return kFailedStatus;
  }
  PackCatalogue& catalogue = **opened;
  if (catalogue.size() == 0) spdlog::warn("no pack in {}: nothing to serve yet", options.packs);

  Metrics metrics;
  showIndexes(metrics, *budget, *indexes);
  showCatalogue(metrics, catalogue);
  RecordService service(catalogue, metrics, serviceOptions(options.server.limits, {}));
  const auto rescan = [&] { catalogue.rescan(); };
  return runServer(
      {.handler = service,
       .metrics = metrics,
       .options = options.server,
       .signals = signals,
       .meanwhile = {.onHangUp = rescan, .every = milliseconds(options.rescan), .onTick = rescan}});
}

}  // namespace

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("meshfront-serve"));
  Options options;
  const auto status = parse(argc, argv, options);
  return status ? *status : serve(options);
}
