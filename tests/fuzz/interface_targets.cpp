#include <cstring>

#include "shared/bits/base64url.h"
#include "shared/hierarchy/tree_bitstring.h"
#include "shared/http/conditional_request.h"
#include "shared/http/route.h"
#include "shared/http/split_request.h"
#include "shared/store/mesh_metadata.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/fuzz/promise.h"

namespace meshfront::fuzz {
namespace {

constexpr size_t kMaxWanted = 4096;
constexpr unsigned kMaxLevelServed = 9;

void checkSet(const Result<SplitRequest>& request, Bytes spelling) {
  if (!request) return;
  const auto& wanted = request->wanted;
  promise(!wanted.empty() && wanted.size() <= kMaxWanted, "the set is as large as allowed");
  for (size_t i = 1; i < wanted.size(); ++i) {
    promise(wanted[i - 1] < wanted[i], "nodes are in preorder");
    promise(!wanted[i - 1].isAncestorOf(wanted[i]), "no node is above another");
  }
  const auto again = encodeTreeBitstring(wanted);
  promise(again && std::ranges::equal(*again, spelling), "a set has one spelling");
}

}  // namespace

bool readMetadata(Bytes input) {
  const auto metadata =
      metadataFromJson({reinterpret_cast<const char*>(input.data()), input.size()});
  if (!metadata) return false;
  promise(isMeshName(metadata->name) && isRevision(metadata->revision), "names are checked");
  const std::string json = toJson(*metadata);
  const auto again = metadataFromJson(json);
  promise(again && toJson(*again) == json, "what is written reads the same");
  return true;
}

bool readRequest(Bytes input) {
  FuzzInput in(input);
  const std::string_view target = in.line();
  const std::string_view condition = in.line();
  static_cast<void>(ifNoneMatchHolds(condition, "\"0123456789abcdef0123456789abcdef\""));
  const Route route = parseTarget(target);
  promise(route.mesh.empty() || isMeshName(route.mesh), "mesh names are checked");
  promise(route.revision.empty() || isRevision(route.revision), "revisions are checked");
  static_cast<void>(canonicalNumber(route.last));
  const auto byUrl =
      parseSplitUrl(route.last, route.hasQuery, route.query, kMaxLevelServed, kMaxWanted);
  if (byUrl) {
    const auto bitstring = base64urlDecode(route.last);
    promise(bitstring && base64urlEncode(*bitstring) == route.last, "IDs have one spelling");
    checkSet(byUrl, *bitstring);
    const std::string spelled =
        splitTarget(route.mesh, route.revision, *bitstring, byUrl->expansion);
    promise(route.kind != RouteKind::splits || target.ends_with(spelled),
            "a request has one target");
  }
  const auto byQuery =
      parseSplitQuery(in.rest(), route.hasQuery, route.query, kMaxLevelServed, kMaxWanted);
  checkSet(byQuery, in.rest());
  return byUrl.has_value() || byQuery.has_value();
}

}  // namespace meshfront::fuzz
