// Which resource of the interface a request target names.
#pragma once

#include <cstdint>
#include <string_view>

namespace meshfront {

enum class RouteKind {
  catalogue,    // /v1/meshes
  mesh,         // /v1/meshes/{mesh}
  base,         // /v1/meshes/{mesh}/{revision}/base
  splits,       // .../splits/{ids}
  querySplits,  // .../splits
  chunks,       // .../chunks
  chunk,        // .../chunks/{n}
  health,
  ready,
  metrics,
  server,  // OPTIONS *
  unknown,
};
inline constexpr unsigned kRouteKinds = static_cast<unsigned>(RouteKind::unknown) + 1;

// For counters: "catalogue", "mesh", ...
[[nodiscard]] const char* routeName(RouteKind kind);
// As the Allow field lists them.
[[nodiscard]] const char* allowedMethods(RouteKind kind);

// Views into the target. The names have been checked for their alphabet; ids and number have not.
struct Route {
  RouteKind kind = RouteKind::unknown;
  std::string_view mesh;
  std::string_view revision;
  std::string_view last;  // ids or chunk number
  std::string_view query;
  bool hasQuery = false;  // a question mark, even with nothing behind it
};

// Untrusted; also takes the absolute form (RFC 9112 section 3.2.2).
[[nodiscard]] Route parseTarget(std::string_view target);

}  // namespace meshfront
