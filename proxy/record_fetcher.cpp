#include "proxy/record_fetcher.h"

#include "shared/hierarchy/tree_bitstring.h"
#include "shared/http/split_request.h"

namespace meshfront {
namespace {

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
    const std::function<std::optional<unsigned>(const NodeId&)>& levelOf) {
  auto bitstring = encodeTreeBitstring(wanted);
  if (!bitstring) return tl::unexpected(bitstring.error());
  const UpstreamRequest request = requestFor(std::move(*bitstring), expansion);
  constexpr int kAttempts = 2;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    counters_.upstreamRequests(RouteKind::splits).add();
    auto response = upstream_.send(request);
    if (!response) return tl::unexpected(response.error());
    if (response->status != 200) return failureOf(response->status);
    counters_.upstreamRecordBytes.add(response->content.size());
    auto entries = parseAnswer(response->content, wanted, expansion, tables, levelOf);
    if (entries)
      return std::make_shared<const FetchedRecords>(
          FetchedRecords{std::move(response->content), std::move(*entries)});
    counters_.wrongAnswers.add();
  }
  return fail(ErrorCode::unavailable, "upstream: a damaged answer, twice");
}

}  // namespace meshfront
