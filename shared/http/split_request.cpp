#include "shared/http/split_request.h"

#include <charconv>
#include <utility>

#include "shared/bits/base64url.h"
#include "shared/hierarchy/tree_bitstring.h"

namespace meshfront {
namespace {

Result<Expansion> parseExpansion(bool hasQuery, std::string_view query, unsigned maxLevel) {
  Expansion expansion;
  if (!hasQuery) return expansion;
  const size_t equals = query.find('=');
  const std::string_view key = query.substr(0, equals);
  if (equals == std::string_view::npos || (key != "levels" && key != "significance"))
    return fail("the query must be levels=K or significance=L, once, or be left out");
  const auto number = canonicalNumber(query.substr(equals + 1));
  if (key == "levels") {
    if (!number || *number == 0 || *number > kMaxDepth)
      return fail("levels must be 1 to " + std::to_string(kMaxDepth) + "; leave out levels=0");
    expansion.levels = *number;
  } else {
    if (!number || *number > maxLevel)
      return fail("significance must be 0 to the mesh's finest level, " + std::to_string(maxLevel));
    expansion.significance = static_cast<uint8_t>(*number);
  }
  return expansion;
}

}  // namespace

std::optional<uint32_t> canonicalNumber(std::string_view text) {
  if (text.empty() || (text.size() > 1 && text.front() == '0')) return std::nullopt;
  uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

Result<SplitRequest> parseSplitQuery(std::span<const uint8_t> content, bool hasQuery,
                                     std::string_view query, unsigned maxLevel, size_t maxWanted) {
  auto expansion = parseExpansion(hasQuery, query, maxLevel);
  if (!expansion) return tl::unexpected(expansion.error());
  auto wanted = decodeTreeBitstring(content, maxWanted);
  if (!wanted) return tl::unexpected(wanted.error());
  if (wanted->empty()) return fail("the set is empty: ask for at least one node");
  return SplitRequest{std::move(*wanted), *expansion};
}

Result<SplitRequest> parseSplitUrl(std::string_view ids, bool hasQuery, std::string_view query,
                                   unsigned maxLevel, size_t maxWanted) {
  auto bitstring = base64urlDecode(ids);
  if (!bitstring) return tl::unexpected(bitstring.error());
  auto request = parseSplitQuery(*bitstring, hasQuery, query, maxLevel, maxWanted);
  if (request) request->fromUrl = std::move(*bitstring);
  return request;
}

std::string expansionQuery(const Expansion& expansion) {
  if (expansion.significance) return "?significance=" + std::to_string(*expansion.significance);
  if (expansion.levels > 0) return "?levels=" + std::to_string(expansion.levels);
  return {};
}

std::string splitTarget(std::string_view mesh, std::string_view revision,
                        std::span<const uint8_t> bitstring, const Expansion& expansion) {
  std::string target = "/v1/meshes/";
  target.append(mesh).append("/").append(revision).append("/splits/");
  return target.append(base64urlEncode(bitstring)).append(expansionQuery(expansion));
}

}  // namespace meshfront
