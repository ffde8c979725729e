#include "shared/receiver/record_request.h"

#include <algorithm>
#include <optional>

#include "shared/bits/base64url.h"
#include "shared/hierarchy/tree_bitstring.h"
#include "shared/store/entity_tag.h"

namespace meshfront {
namespace {

// A record is 27 to 38 bits on average; this is far above the longest one.
constexpr size_t kMaxRecordBytes = 512;
constexpr size_t kMaxExpandedBytes = size_t{64} << 20;

}  // namespace

std::string expansionParameter(const Expansion& expansion) {
  if (expansion.significance) return "significance=" + std::to_string(*expansion.significance);
  if (expansion.levels > 0) return "levels=" + std::to_string(expansion.levels);
  return {};
}

Result<FetchRequest> toFetch(const MeshUrl& url, std::string_view revision,
                             const RecordRequest& request, SpelledSet* spelled) {
  Result<std::vector<uint8_t>> bits = encodeTreeBitstring(request.nodes);
  if (!bits) return tl::unexpected(bits.error());
  if (spelled != nullptr) *spelled = {bits->size(), recordsKey(revision, *bits, request.expansion)};
  const std::string parameter = expansionParameter(request.expansion);
  FetchRequest http;
  http.maxBodyBytes =
      request.expansion.none() ? 64 + request.nodes.size() * kMaxRecordBytes : kMaxExpandedBytes;
  // Four characters per three octets: no need to spell a set that cannot fit.
  if (bits->size() / 3 * 4 < kMaxUrlOctets) {
    http.url = url.splits(revision, base64urlEncode(*bits), parameter);
    if (http.url.size() <= kMaxUrlOctets) return http;
  }
  http.method = FetchRequest::Method::query;
  http.url = url.splitsQuery(revision, parameter);
  http.content = std::move(*bits);
  http.contentType = "application/octet-stream";
  return http;
}

Result<std::vector<RecordEntry>> parseRecords(std::span<const uint8_t> bytes,
                                              const RecordRequest& request,
                                              const CodeTables& tables) {
  const auto levelOf = [&request](const NodeId& id) -> std::optional<unsigned> {
    const auto found = std::lower_bound(request.nodes.begin(), request.nodes.end(), id);
    if (found == request.nodes.end() || *found != id) return std::nullopt;
    return request.levels[static_cast<size_t>(found - request.nodes.begin())];
  };
  return parseAnswer(bytes, request.nodes, request.expansion, tables, levelOf);
}

}  // namespace meshfront
