#include "shared/http/server/server_options.h"

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <thread>
#include <variant>

namespace meshfront {
namespace {

struct LimitOption {
  const char* name;
  const char* unit;
  std::variant<size_t ServerLimits::*, double ServerLimits::*> member;
  double least;
  double most;
  const char* what;  // and the status of what lies beyond
};

constexpr const char* kCount = "COUNT";
constexpr const char* kSize = "SIZE";  // octets, with a suffix: 1MiB
constexpr const char* kSeconds = "SECONDS";
constexpr double kMiB = 1 << 20;

const std::array<LimitOption, 14> kLimitOptions{{
    {"--max-target", "OCTETS", &ServerLimits::maxTarget, kMaxTargetOctets, 32768,
     "octets of a URL; 414. Caches on the way take few more than 8,000"},
    {"--max-header", kSize, &ServerLimits::maxHeader, 1024, 65536, "a request's fields; 431"},
    {"--max-content", kSize, &ServerLimits::maxContent, 1024, 16 * kMiB,
     "a request's content; 413"},
    {"--max-ids", kCount, &ServerLimits::maxIds, 1, 16 * kMiB, "nodes in a request; 413"},
    {"--max-levels", kCount, &ServerLimits::maxLevels, 1, kMaxDepth,
     "generations of descendants in a request; 413"},
    {"--max-records", kCount, &ServerLimits::maxRecords, 1, 256 * kMiB,
     "records in an answer; 413"},
    {"--max-answer", kSize, &ServerLimits::maxAnswer, 1024, 1024 * kMiB,
     "octets of the records in an answer; 413"},
    {"--max-connections", kCount, &ServerLimits::maxConnections, 1, 1e6,
     "connections; those beyond get 503"},
    {"--max-connections-per-address", kCount, &ServerLimits::maxConnectionsPerAddress, 1, 1e6,
     "connections from one IPv4 address or IPv6 /64; those beyond get 429"},
    {"--header-timeout", kSeconds, &ServerLimits::headerTimeout, 0.1, 3600,
     "from a request's first octet to the end of its fields; 408"},
    {"--content-timeout", kSeconds, &ServerLimits::contentTimeout, 0.1, 3600,
     "from there to the end of its content; 408"},
    {"--answer-timeout", kSeconds, &ServerLimits::answerTimeout, 0.1, 86400,
     "from there to the answer's last octet; then the connection is cut"},
    {"--idle-timeout", kSeconds, &ServerLimits::idleTimeout, 1, 86400,
     "for which a silent connection is kept"},
    {"--memory-in-flight", kSize, &ServerLimits::memoryInFlight, 1024, 1e12,
     "contents and answers of all requests together; 503"},
}};

// 33554432 as "32MiB".
std::string sizeText(size_t bytes) {
  constexpr std::array<const char*, 4> kUnits{"", "KiB", "MiB", "GiB"};
  size_t unit = 0;
  while (unit + 1 < kUnits.size() && bytes >= 1024 && bytes % 1024 == 0) {
    bytes /= 1024;
    ++unit;
  }
  return std::to_string(bytes) + kUnits[unit];
}

void addLimit(CLI::App& app, const LimitOption& limit, ServerLimits& limits) {
  const bool isSize = limit.unit == kSize;
  CLI::Option* option = nullptr;
  if (const auto* count = std::get_if<size_t ServerLimits::*>(&limit.member)) {
    size_t& value = limits.**count;
    option = app.add_option(limit.name, value, limit.what);
    option->check(CLI::Range(static_cast<size_t>(limit.least), static_cast<size_t>(limit.most))
                      .description(""));
    // Transformed before it is checked: transformations come first.
    if (isSize) option->transform(CLI::AsSizeValue(false).description(""));
    option->default_str(isSize ? sizeText(value) : std::to_string(value));
  } else {
    double& value = limits.*std::get<double ServerLimits::*>(limit.member);
    option = app.add_option(limit.name, value, limit.what);
    option->check(CLI::Range(limit.least, limit.most).description(""))->capture_default_str();
  }
  option->type_name(limit.unit)->group("Limits");
}

bool checkTogether(const ServerLimits& limits) {
  if (limits.memoryInFlight >= limits.maxAnswer + limits.maxContent) return true;
  std::fprintf(stderr,
               "--memory-in-flight must hold at least one request: --max-answer and --max-content "
               "together\n");
  return false;
}

}  // namespace

void addServerOptions(CLI::App& app, ServerOptions& options) {
  options.threads = std::max(1U, std::thread::hardware_concurrency());
  app.add_option("--listen", options.listen, "where to listen; port 0 takes a free one")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  app.add_option("--threads", options.threads, "threads that serve connections")
      ->check(CLI::Range(1U, 256U))
      ->capture_default_str();
  app.add_option("--access-log", options.accessLog,
                 "file that gets a line for each request, - for standard output; opened anew on "
                 "SIGHUP; default: none")
      ->type_name("FILE");
  const std::map<std::string, AccessLog::Format> formats{{"text", AccessLog::Format::text},
                                                         {"json", AccessLog::Format::json}};
  app.add_option("--access-log-format", options.accessLogFormat, "text (common log format) or json")
      ->transform(CLI::CheckedTransformer(formats, CLI::ignore_case).description(""))
      ->type_name("FORMAT")
      ->default_str("text");
  for (const LimitOption& limit : kLimitOptions) addLimit(app, limit, options.limits);
}

std::optional<int> parseServerOptions(CLI::App& app, int argc, const char* const* argv,
                                      ServerOptions& options) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kUsageStatus;
  }
  if (!checkTogether(options.limits)) return kUsageStatus;
  auto address = resolveListenAddress(options.listen);
  if (!address) {
    std::fprintf(stderr, "%s\n", address.error().message.c_str());
    return kUsageStatus;
  }
  options.address = std::move(*address);
  return std::nullopt;
}

RecordService::Options serviceOptions(const ServerLimits& limits, std::string via) {
  RecordService::Options options;
  options.limits = {limits.maxIds, limits.maxRecords, limits.maxAnswer};
  options.maxTarget = limits.maxTarget;
  options.maxContent = limits.maxContent;
  options.maxLevels = limits.maxLevels;
  options.via = std::move(via);
  return options;
}

}  // namespace meshfront
