// The command line of meshfront-load.
#pragma once

#include <optional>
#include <string>

#include "load/load_run.h"
#include "load/view_choice.h"

namespace meshfront {

struct LoadOptions {
  LoadRunOptions run;
  std::string urlText;
  std::string views;  // as ViewChoice::read takes it
  double zipfExponent = 1;
  uint64_t seed = 1;
  unsigned connections = 0;   // 0: one for each request that may be under way, at most 1,024
  std::string originMetrics;  // http://HOST:PORT; empty: not asked
  std::string proxyMetrics;   // likewise
  bool json = false;
  bool verbose = false;  // a line a second although stderr is no terminal
};

// Nothing to run (help, version, wrong usage): `exitCode` is set, and what there is to say has been
// said. Else the options.
struct ParsedLoadOptions {
  std::optional<int> exitCode;
  LoadOptions options;
};
[[nodiscard]] ParsedLoadOptions parseLoadOptions(int argc, char** argv);

}  // namespace meshfront
