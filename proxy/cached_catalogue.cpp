#include "proxy/cached_catalogue.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "shared/store/entity_tag.h"
#include "shared/store/mesh_metadata.h"

namespace meshfront {
namespace {

std::string_view asText(std::span<const uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool isCatalogue(const UpstreamResponse& response) {
  if (isTagOfOtherDocument(response.etag, response.content)) return false;
  const auto json = nlohmann::json::parse(asText(response.content), nullptr, false);
  return json.is_object() && json.contains("meshes") && json["meshes"].is_array();
}

Described describedBy(const Document& document) {
  return {document.content, document.age};
}

}  // namespace

Result<Described> CachedCatalogue::list(Waiting waiting) {
  return parts_.documents.get("/v1/meshes", RouteKind::catalogue, waiting, &isCatalogue)
      .map(describedBy);
}

Result<Described> CachedCatalogue::describe(std::string_view mesh, Waiting waiting) {
  const auto isOfMesh = [name = std::string(mesh)](const UpstreamResponse& response) {
    if (isTagOfOtherDocument(response.etag, response.content)) return false;
    const auto metadata = metadataFromJson(asText(response.content));
    return metadata && metadata->name == name;
  };
  return parts_.documents.get("/v1/meshes/" + std::string(mesh), RouteKind::mesh, waiting, isOfMesh)
      .map(describedBy);
}

Result<std::shared_ptr<RecordStore>> CachedCatalogue::open(std::string_view mesh,
                                                           std::string_view revision,
                                                           Waiting waiting) {
  std::string key(mesh);
  key.append("/").append(revision);
  if (auto store = known(key)) return store;
  auto opened = CachedStore::open(parts_, std::string(mesh), std::string(revision), waiting);
  if (!opened) return tl::unexpected(opened.error());
  return remember(key, std::move(*opened));
}

std::shared_ptr<CachedStore> CachedCatalogue::known(const std::string& key) {
  const std::scoped_lock lock(mutex_);
  const auto it = stores_.find(key);
  if (it == stores_.end()) return nullptr;
  it->second.lastUse = ++uses_;
  return it->second.store;
}

std::shared_ptr<CachedStore> CachedCatalogue::remember(const std::string& key,
                                                       std::shared_ptr<CachedStore> store) {
  std::shared_ptr<CachedStore> oldest;  // destroyed after the lock is given up
  const std::scoped_lock lock(mutex_);
  // Two threads may have opened it: the first counts, so that its records are not split in two.
  auto [it, isNew] = stores_.try_emplace(key, Opened{std::move(store), 0});
  it->second.lastUse = ++uses_;
  std::shared_ptr<CachedStore> kept = it->second.store;
  if (stores_.size() > kMaxStores) {
    const auto leastUsed = std::min_element(
        stores_.begin(), stores_.end(),
        [](const auto& a, const auto& b) { return a.second.lastUse < b.second.lastUse; });
    oldest = std::move(leastUsed->second.store);
    stores_.erase(leastUsed);
  }
  return kept;
}

}  // namespace meshfront
