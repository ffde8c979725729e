#include "shared/receiver/mesh_url.h"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "shared/store/mesh_metadata.h"

namespace meshfront {
namespace {

constexpr std::string_view kExample = "expected http://HOST:PORT/v1/meshes/NAME";

tl::unexpected<Error> wrong(std::string_view url, const std::string& what) {
  return fail("the URL '" + std::string(url.substr(0, 200)) + "' " + what + "; " +
              std::string(kExample));
}

bool isHostCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' || c == '_';
}

// Host with an optional port; an IPv6 address stands in brackets.
bool isAuthority(std::string_view text, std::string& problem) {
  std::string_view host = text;
  std::string_view port;
  if (text.starts_with('[')) {
    const size_t close = text.find(']');
    if (close == std::string_view::npos || close < 3) {
      problem = "has an IPv6 address without its closing bracket";
      return false;
    }
    host = text.substr(1, close - 1);
    const auto isAddress = [](char c) {
      return std::isxdigit(static_cast<unsigned char>(c)) != 0 || c == ':' || c == '.';
    };
    if (!std::all_of(host.begin(), host.end(), isAddress)) {
      problem = "has a wrong IPv6 address";
      return false;
    }
    const std::string_view rest = text.substr(close + 1);
    if (rest.empty()) return true;
    if (rest.front() != ':') {
      problem = "has something other than a port behind the host";
      return false;
    }
    port = rest.substr(1);
  } else {
    const size_t colon = text.find(':');
    host = text.substr(0, colon);
    if (host.empty()) {
      problem = "names no host";
      return false;
    }
    if (!std::all_of(host.begin(), host.end(), isHostCharacter)) {
      problem = "has a wrong host name";
      return false;
    }
    if (colon == std::string_view::npos) return true;
    port = text.substr(colon + 1);
  }
  unsigned number = 0;
  const auto [end, code] = std::from_chars(port.data(), port.data() + port.size(), number);
  if (code != std::errc() || end != port.data() + port.size() || number == 0 || number > 65535) {
    problem = "has a wrong port (1 to 65535)";
    return false;
  }
  return true;
}

}  // namespace

std::string MeshUrl::base(std::string_view revision) const {
  return metadata() + "/" + std::string(revision) + "/base";
}

std::string MeshUrl::splits(std::string_view revision, std::string_view ids,
                            std::string_view parameter) const {
  std::string url = metadata();
  url.append("/").append(revision).append("/splits/").append(ids);
  if (!parameter.empty()) url.append("?").append(parameter);
  return url;
}

std::string MeshUrl::splitsQuery(std::string_view revision, std::string_view parameter) const {
  std::string url = metadata();
  url.append("/").append(revision).append("/splits");
  if (!parameter.empty()) url.append("?").append(parameter);
  return url;
}

std::string MeshUrl::chunkIndex(std::string_view revision) const {
  return metadata() + "/" + std::string(revision) + "/chunks";
}

std::string MeshUrl::chunk(std::string_view revision, uint32_t number) const {
  return chunkIndex(revision) + "/" + std::to_string(number);
}

Result<MeshUrl> parseMeshUrl(std::string_view url) {
  MeshUrl result;
  const size_t scheme = url.find("://");
  if (scheme == std::string_view::npos) return wrong(url, "has no scheme");
  const std::string_view name = url.substr(0, scheme);
  if (name != "http" && name != "https")
    return wrong(url, "has the scheme '" + std::string(name) + "', neither http nor https");
  const std::string_view rest = url.substr(scheme + 3);
  const size_t slash = rest.find('/');
  const std::string_view authority = rest.substr(0, slash);
  if (authority.find('@') != std::string_view::npos)
    return wrong(url, "holds credentials, which are not supported");
  std::string problem;
  if (!isAuthority(authority, problem)) return wrong(url, problem);
  result.origin = std::string(url.substr(0, scheme + 3)) + std::string(authority);
  std::string_view path = slash == std::string_view::npos ? "" : rest.substr(slash);
  if (path.find_first_of("?#") != std::string_view::npos)
    return wrong(url, "has a query or a fragment");
  while (path.ends_with('/')) path.remove_suffix(1);

  constexpr std::string_view kMarker = "/meshes/";
  const size_t meshes = path.rfind(kMarker);
  if (meshes == std::string_view::npos) return wrong(url, "names no mesh");
  const std::string_view mesh = path.substr(meshes + kMarker.size());
  const std::string_view before = path.substr(0, meshes);
  const size_t version = before.rfind('/');
  if (version == std::string_view::npos) return wrong(url, "lacks the version /v1");
  if (before.substr(version) != "/v1") {
    return wrong(url, "asks for version '" + std::string(before.substr(version + 1)) +
                          "' of the interface, this program speaks v1");
  }
  const std::string_view prefix = before.substr(0, version);
  const auto isPathCharacter = [](char c) {
    return std::isgraph(static_cast<unsigned char>(c)) != 0 && c != '"' && c != '<' && c != '>';
  };
  if (!std::all_of(prefix.begin(), prefix.end(), isPathCharacter))
    return wrong(url, "has a path with characters that must be escaped");
  if (!isMeshName(mesh)) {
    return wrong(url,
                 "has a wrong mesh name (letters, digits, '.', '_', '-'; at most 64; no dot "
                 "in front)");
  }
  result.prefix = std::string(prefix);
  result.name = std::string(mesh);
  return result;
}

}  // namespace meshfront
