// The options that every server has, and the way from its command line to its end.
//
//   ServerOptions server{.listen = "127.0.0.1:8080"};
//   CLI::App app("Serves packs over HTTP.", "meshfront-serve");
//   app.add_option("--packs", ...);
//   addServerOptions(app, server);
//   if (const auto status = parseServerOptions(app, argc, argv, server)) return *status;
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "shared/http/record_service.h"
#include "shared/http/server/access_log.h"
#include "shared/http/server/listen_address.h"
#include "shared/http/server/server_limits.h"

namespace CLI {
class App;
}  // namespace CLI

namespace meshfront {

inline constexpr int kFailedStatus = 1;
inline constexpr int kUsageStatus = 2;

struct ServerOptions {
  std::string listen{};  // HOST:PORT
  unsigned threads = 1;
  std::string accessLog{};  // a file, "-" for standard output, or nothing
  AccessLog::Format accessLogFormat = AccessLog::Format::text;
  ServerLimits limits{};
  ListenAddress address{};  // of `listen`, once parsed
};

// --listen, --threads, --access-log, --access-log-format, and the table of limits: an option for
// each member of ServerLimits, with its unit, range and default.
void addServerOptions(CLI::App& app, ServerOptions& options);

// Parses, checks what belongs together, and resolves the address. An exit status where the program
// is to end now: after --help, or because of wrong usage, which it then has said.
[[nodiscard]] std::optional<int> parseServerOptions(CLI::App& app, int argc,
                                                    const char* const* argv,
                                                    ServerOptions& options);

// What of the limits the record service looks after.
[[nodiscard]] RecordService::Options serviceOptions(const ServerLimits& limits, std::string via);

}  // namespace meshfront
