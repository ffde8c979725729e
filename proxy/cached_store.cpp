#include "proxy/cached_store.h"

#include "shared/bits/crc32c.h"
#include "shared/codec/chunk.h"
#include "shared/store/entity_tag.h"
#include "shared/store/request_walk.h"

namespace meshfront {
namespace {

std::string prefixOf(const std::string& mesh, const std::string& revision) {
  return "/v1/meshes/" + mesh + "/" + revision + "/";
}

}  // namespace

Result<std::shared_ptr<CachedStore>> CachedStore::open(const Parts& parts, const std::string& mesh,
                                                       const std::string& revision,
                                                       Waiting waiting) {
  const auto document =
      parts.documents.get(prefixOf(mesh, revision) + "base", RouteKind::base, waiting,
                          [key = resourceKey(revision, "base")](const UpstreamResponse& response) {
                            return !isTagOfOtherResource(response.etag, key) &&
                                   decodeBaseMesh(response.content).has_value();
                          });
  if (!document) return tl::unexpected(document.error());
  auto base = decodeBaseMesh(document->content.bytes());
  if (!base) return fail(ErrorCode::unavailable, "upstream: " + base.error().message);
  return std::shared_ptr<CachedStore>(
      new CachedStore(parts, mesh, revision, std::move(*base), document->age));
}

CachedStore::CachedStore(const Parts& parts, const std::string& mesh, const std::string& revision,
                         BaseMesh base, std::chrono::seconds age)
    : parts_(parts),
      prefix_(prefixOf(mesh, revision)),
      revision_(revision),
      roots_(std::move(base.roots)),
      tables_(std::make_shared<const CodeTables>(std::move(base.tables))),
      opened_(std::chrono::steady_clock::now() - age),
      cache_(parts.budget),
      fetcher_(parts.upstream, parts.memory, parts.counters, mesh, revision) {}

std::optional<std::chrono::seconds> CachedStore::age() const {
  return std::chrono::duration_cast<std::chrono::seconds>(std::chrono::steady_clock::now() -
                                                          opened_);
}

Result<HeldBytes> CachedStore::document(const std::string& resource, RouteKind kind,
                                        Waiting waiting) {
  // By value: the check may be made later. The store's own tables die with it.
  const auto isRight = [key = resourceKey(revision_, resource), kind,
                        tables = tables_](const UpstreamResponse& response) {
    if (isTagOfOtherResource(response.etag, key)) return false;
    if (kind == RouteKind::base) return decodeBaseMesh(response.content).has_value();
    if (kind == RouteKind::chunks) return decodeChunkIndex(response.content).has_value();
    return decodeChunk(response.content, *tables).has_value();
  };
  return parts_.documents.get(prefix_ + resource, kind, waiting, isRight)
      .map([](const Document& document) { return document.content; });
}

Result<HeldBytes> CachedStore::base(Waiting waiting) {
  return document("base", RouteKind::base, waiting);
}

Result<HeldBytes> CachedStore::chunkIndex(Waiting waiting) {
  return document("chunks", RouteKind::chunks, waiting);
}

Result<HeldBytes> CachedStore::chunk(uint32_t number, Waiting waiting) {
  return document("chunks/" + std::to_string(number), RouteKind::chunk, waiting);
}

Result<std::optional<Answer>> CachedStore::collectCached(std::span<const NodeId> wanted,
                                                         const Expansion& expansion,
                                                         const CollectLimits& limits) {
  BitWriter out;
  uint64_t records = 0;
  bool lacking = false;
  bool tooLarge = false;
  RecordCache::Reader reader(cache_);
  walkRequest(
      wanted, expansion,
      [&](const NodeId& node, const Expansion&) {
        const auto facts = reader.find(node, &out);
        lacking = !facts;
        tooLarge = ++records > limits.maxRecords || out.bitCount() / 8 > limits.maxBytes;
        return facts;
      },
      [&] { return lacking || tooLarge; });
  if (tooLarge)
    return fail(ErrorCode::tooLarge, "the answer would be too large; ask for fewer nodes");
  if (lacking) return std::optional<Answer>();
  parts_.counters.recordHits.add(records);
  Answer answer{out.take(), records, 0};
  appendChecksum(answer.bytes);
  return std::optional<Answer>(std::move(answer));
}

Result<Answer> CachedStore::collect(std::span<const NodeId> wanted, const Expansion& expansion,
                                    const CollectLimits& limits, Waiting waiting) {
  // With waiting allowed this was tried just before, and the gathering looks again anyway.
  if (waiting == Waiting::refused) {
    auto cached = collectCached(wanted, expansion, limits);
    if (!cached) return tl::unexpected(cached.error());
    if (*cached) return std::move(**cached);
    return fail(ErrorCode::unavailable, "records have to be fetched");
  }
  RecordGathering gathering({roots_, *tables_, cache_, fetcher_, underWay_, parts_.budget,
                             parts_.memory, parts_.counters},
                            limits);
  return gathering.collect(wanted, expansion);
}

}  // namespace meshfront
