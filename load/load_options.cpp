#include "load/load_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <map>
#include <thread>

namespace meshfront {
namespace {

constexpr unsigned kMostConnections = 1'024;

// "500x500"
std::string parsePicture(const std::string& text, PixelSize& size) {
  const size_t by = text.find('x');
  const auto side = [](std::string_view digits, int& value) {
    const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return code == std::errc() && end == digits.data() + digits.size() && value >= 1 &&
           value <= 16'384;
  };
  const std::string_view view = text;
  if (by != std::string::npos && side(view.substr(0, by), size.width) &&
      side(view.substr(by + 1), size.height))
    return {};
  return "expected WIDTHxHEIGHT in pixels, such as 500x500";
}

}  // namespace

ParsedLoadOptions parseLoadOptions(int argc, char** argv) {
  ParsedLoadOptions parsed;
  LoadOptions& options = parsed.options;
  LoadRunOptions& run = options.run;
  run.workers = std::max(1U, std::thread::hardware_concurrency());
  CLI::App app("Simulates many receivers that stream a mesh, each from its own view.",
               "meshfront-load");
  app.set_version_flag("--version", "meshfront-load 0.1.0");
  app.footer(
      "Each receiver is the viewer's own, with pixels estimated from projected triangles instead "
      "of\n"
      "drawn ones. Its mesh takes memory (about 2 to 4 MB for 36 thousand vertices), which "
      "--concurrency\n"
      "bounds.\n"
      "Exit codes: 0 every receiver that ended has settled, 1 one has failed, 2 wrong usage.");
  double duration = 0;
  double patience = 60;
  std::string picture;
  app.add_option("--url", options.urlText, "http://HOST:PORT/v1/meshes/NAME")
      ->required()
      ->check(CLI::Validator(
          [&run](std::string& text) {
            auto url = parseMeshUrl(text);
            if (!url) return url.error().message;
            run.url = *url;
            return std::string();
          },
          "URL"));
  app.add_option("--views", options.views,
                 "zipf:FILE (few of the file's cameras are looked from by many) or each:FILE (line "
                 "after line); a camera a line, as meshfront-view --camera takes it")
      ->required();
  app.add_option("--zipf-exponent", options.zipfExponent,
                 "view k with a probability proportional to 1/k^exponent")
      ->check(CLI::Range(0.0, 10.0).description(""))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of the drawn views")->capture_default_str();
  app.add_option("--receivers", run.receivers, "in all")
      ->check(CLI::Range(uint64_t{1}, uint64_t{100'000'000}).description(""))
      ->capture_default_str();
  app.add_option("--concurrency", run.concurrency, "receivers alive at a time")
      ->check(CLI::Range(uint64_t{1}, uint64_t{100'000}).description(""))
      ->capture_default_str();
  app.add_option("--arrivals", run.arrivalRate,
                 "receivers that start a second; 0: as soon as one is done")
      ->check(CLI::Range(0.0, 1e6).description(""))
      ->capture_default_str();
  app.add_option("--duration", duration, "seconds until those alive are given up; 0: none are")
      ->check(CLI::Range(0.0, 1e7).description(""))
      ->capture_default_str();
  app.add_option("--workers", run.workers, "threads for receivers")
      ->check(CLI::Range(1U, 256U).description(""))
      ->capture_default_str();
  app.add_option("--connections", options.connections,
                 "shared by all; 0: one for each request that may be under way, at most 1024")
      ->check(CLI::Range(0U, 20'000U).description(""))
      ->capture_default_str();
  const std::map<std::string, FetchMode> modes{{"exact", FetchMode::exact},
                                               {"chunks", FetchMode::chunks}};
  app.add_option("--fetch", run.receiver.mode,
                 "exact (default) or chunks, as meshfront-view has it")
      ->transform(CLI::CheckedTransformer(modes).description(""));
  app.add_option("--batch", run.receiver.batch, "exact: records a request; 0: 200 to 2000")
      ->check(CLI::Range(0U, 100'000U).description(""))
      ->capture_default_str();
  app.add_option("--window", run.receiver.window,
                 "requests under way of a receiver, 1 to 16; 0: 1 for exact sets, 4 for chunks")
      ->check(CLI::Range(0U, 16U).description(""))
      ->capture_default_str();
  app.add_option("--size", picture, "each receiver's picture in pixels (default 500x500)")
      ->check(CLI::Validator(
          [&run](std::string& text) { return parsePicture(text, run.receiver.picture); }, ""));
  app.add_option("--patience", patience,
                 "seconds for which a receiver that has lost the server tries again")
      ->check(CLI::Range(0.0, 1e6).description(""))
      ->capture_default_str();
  app.add_option("--origin-metrics", options.originMetrics,
                 "http://HOST:PORT of the service: tells its share of the record bytes");
  app.add_option("--proxy-metrics", options.proxyMetrics,
                 "http://HOST:PORT of the proxy: tells what it served and fetched");
  app.add_flag("--json", options.json, "print the result as JSON");
  app.add_flag("--verbose", options.verbose, "a line a second even where stderr is no terminal");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    parsed.exitCode = app.exit(error) == 0 ? 0 : 2;
    return parsed;
  }
  run.duration = std::chrono::duration<double>(duration);
  run.receiver.patience = std::chrono::milliseconds(static_cast<int64_t>(patience * 1000));
  if (options.connections == 0) {
    ReceiverOptions one;
    one.mode = run.receiver.mode;
    one.window = run.receiver.window;
    const uint64_t most = std::min(run.concurrency, run.receivers) * windowOf(one);
    options.connections = static_cast<unsigned>(std::min<uint64_t>(most, kMostConnections));
  }
  return parsed;
}

}  // namespace meshfront
