#include "shared/http/route.h"

#include <array>
#include <vector>

#include "shared/store/mesh_metadata.h"

namespace meshfront {
namespace {

std::string_view originForm(std::string_view target) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (!target.starts_with(scheme)) continue;
    const size_t path = target.find('/', scheme.size());
    return path == std::string_view::npos ? "/" : target.substr(path);
  }
  return target;
}

Route parseMeshPath(std::string_view path, Route route) {
  std::array<std::string_view, 4> parts;  // mesh, revision, resource, last
  size_t count = 0;
  while (true) {
    if (count == parts.size()) return route;
    const size_t slash = path.find('/');
    parts[count++] = path.substr(0, slash);
    if (slash == std::string_view::npos) break;
    path.remove_prefix(slash + 1);
  }
  if (!isMeshName(parts[0])) return route;
  route.mesh = parts[0];
  if (count == 1) {
    route.kind = RouteKind::mesh;
    return route;
  }
  if (count == 2 || !isRevision(parts[1])) return route;
  route.revision = parts[1];
  const std::string_view resource = parts[2];
  if (count == 3) {
    if (resource == "base") route.kind = RouteKind::base;
    if (resource == "splits") route.kind = RouteKind::querySplits;
    if (resource == "chunks") route.kind = RouteKind::chunks;
    return route;
  }
  route.last = parts[3];
  if (resource == "splits") route.kind = RouteKind::splits;
  if (resource == "chunks") route.kind = RouteKind::chunk;
  return route;
}

}  // namespace

const char* routeName(RouteKind kind) {
  switch (kind) {
    case RouteKind::catalogue:
      return "catalogue";
    case RouteKind::mesh:
      return "mesh";
    case RouteKind::base:
      return "base";
    case RouteKind::splits:
      return "splits";
    case RouteKind::querySplits:
      return "query-splits";
    case RouteKind::chunks:
      return "chunks";
    case RouteKind::chunk:
      return "chunk";
    case RouteKind::health:
      return "healthz";
    case RouteKind::ready:
      return "readyz";
    case RouteKind::metrics:
      return "metrics";
    case RouteKind::server:
      return "server";
    case RouteKind::unknown:
      break;
  }
  return "unknown";
}

const char* allowedMethods(RouteKind kind) {
  if (kind == RouteKind::querySplits) return "QUERY, OPTIONS";
  if (kind == RouteKind::server) return "GET, HEAD, QUERY, OPTIONS";
  return "GET, HEAD, OPTIONS";
}

Route parseTarget(std::string_view target) {
  Route route;
  if (target == "*") {
    route.kind = RouteKind::server;
    return route;
  }
  target = originForm(target);
  const size_t question = target.find('?');
  const std::string_view path = target.substr(0, question);
  if (question != std::string_view::npos) {
    route.hasQuery = true;
    route.query = target.substr(question + 1);
  }
  constexpr std::string_view kMeshes = "/v1/meshes";
  if (path == kMeshes) {
    route.kind = RouteKind::catalogue;
  } else if (path == "/healthz") {
    route.kind = RouteKind::health;
  } else if (path == "/readyz") {
    route.kind = RouteKind::ready;
  } else if (path == "/metrics") {
    route.kind = RouteKind::metrics;
  } else if (path.starts_with(kMeshes) && path.substr(kMeshes.size()).starts_with('/')) {
    return parseMeshPath(path.substr(kMeshes.size() + 1), route);
  }
  return route;
}

}  // namespace meshfront
