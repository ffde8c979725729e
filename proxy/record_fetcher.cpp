#include "proxy/record_fetcher.h"

#include <algorithm>

#include "shared/hierarchy/tree_bitstring.h"
#include "shared/http/split_request.h"
#include "shared/store/entity_tag.h"

namespace meshfront {
namespace {

constexpr size_t kMaxRecordBytes = size_t{2} << 10;  // RecordCache::kMaxLength, 27 to 38 bits usual
constexpr size_t kBytesBeside = 64;

tl::unexpected<Error> failureOf(unsigned status) {
  switch (status) {
    case 404:
      return fail(ErrorCode::notFound, "no such revision or node");
    case 413:
      return fail(ErrorCode::tooLarge, "the answer would be too large; ask for fewer nodes");
    case 504:
      return fail(ErrorCode::timedOut, "upstream: status 504");
    default:
      break;
  }
  return fail(ErrorCode::unavailable, "upstream: status " + std::to_string(status));
}

}  // namespace

UpstreamRequest RecordFetcher::requestFor(std::vector<uint8_t> bitstring,
                                          const Expansion& expansion) const {
  UpstreamRequest request;
  request.target = splitTarget(mesh_, revision_, bitstring, expansion);
  if (request.target.size() <= kMaxTargetOctets) return request;
  request.query = true;
  request.target = "/v1/meshes/" + mesh_ + "/" + revision_ + "/splits" + expansionQuery(expansion);
  request.content = std::move(bitstring);
  return request;
}

Result<SharedRecords> RecordFetcher::fetch(
    std::span<const NodeId> wanted, const Expansion& expansion, const CodeTables& tables,
    const std::function<std::optional<unsigned>(const NodeId&)>& levelOf,
    const CollectLimits& limits) {
  auto bitstring = encodeTreeBitstring(wanted);
  if (!bitstring) return tl::unexpected(bitstring.error());
  const uint32_t key = recordsKey(revision_, *bitstring, expansion);
  UpstreamRequest request = requestFor(std::move(*bitstring), expansion);
  request.memory = &memory_;
  request.maxBytes = limits.maxBytes + kBytesBeside;
  if (expansion.none())
    request.maxBytes = std::min(request.maxBytes, wanted.size() * kMaxRecordBytes + kBytesBeside);
  constexpr int kAttempts = 2;
  bool tooLarge = false;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    counters_.upstreamRequests(RouteKind::splits).add();
    auto response = upstream_.send(request);
    if (response) {
      if (response->status != 200) return failureOf(response->status);
      counters_.upstreamRecordBytes.add(response->content.size());
      auto checked = check(std::move(*response), wanted, expansion, tables, levelOf, limits, key);
      if (!checked) return tl::unexpected(checked.error());
      if (*checked) return std::move(**checked);
    } else {
      tooLarge = response.error().code == ErrorCode::tooLarge;
      if (!tooLarge) return tl::unexpected(response.error());
    }
    counters_.wrongAnswers.add();
  }
  // A whole expansion may well be more than this proxy lets through.
  if (tooLarge && !expansion.none()) return failureOf(413);
  return fail(ErrorCode::unavailable, "upstream: a damaged answer, twice");
}

Result<std::optional<SharedRecords>> RecordFetcher::check(
    UpstreamResponse response, std::span<const NodeId> wanted, const Expansion& expansion,
    const CodeTables& tables, const std::function<std::optional<unsigned>(const NodeId&)>& levelOf,
    const CollectLimits& limits, uint32_t key) {
  if (isTagOfOtherResource(response.etag, key)) return std::optional<SharedRecords>();
  // Twice, because vectors grow by doubling.
  const size_t affordable = response.memory.left() / (2 * sizeof(RecordEntry));
  auto entries = parseAnswer(response.content, wanted, expansion, tables, levelOf,
                             std::min(limits.maxRecords, affordable));
  if (!entries && entries.error().code == ErrorCode::tooLarge)
    return affordable < limits.maxRecords ? noFetchMemory() : failureOf(413);
  if (!entries) return std::optional<SharedRecords>();
  if (!response.memory.take(entries->capacity() * sizeof(RecordEntry))) return noFetchMemory();
  return std::make_shared<const FetchedRecords>(
      FetchedRecords{std::move(response.content), std::move(*entries), std::move(response.memory)});
}

}  // namespace meshfront
