#include "service/pack_catalogue.h"

#include <spdlog/spdlog.h>

#include <algorithm>

namespace meshfront {

Result<std::unique_ptr<PackCatalogue>> PackCatalogue::read(const std::filesystem::path& folder,
                                                           std::shared_ptr<MemoryBudget> budget,
                                                           Options options) {
  const auto found = findPacks(folder);
  if (!found) return tl::unexpected(found.error());
  std::unique_ptr<PackCatalogue> catalogue(
      new PackCatalogue(folder, std::move(budget), std::move(options)));
  catalogue->takeUp(*found, Checks::metadata);
  catalogue->publish();
  return catalogue;
}

void PackCatalogue::rescan() {
  const std::scoped_lock scan(scanning_);
  const auto found = findPacks(folder_);
  if (!found) {
    if (!folderLost_) spdlog::error("{}; serving what is known", found.error().message);
    folderLost_ = true;
    const std::unique_lock lock(mutex_);
    ++counts_.lostScans;
    return;
  }
  folderLost_ = false;
  const bool changed = takeUp(*found, Checks::directory);
  if (changed) return publish();
  std::vector<Retired> dropped;  // destroyed after the lock is given up
  const std::unique_lock lock(mutex_);
  retire(meshes_, dropped);
}

bool PackCatalogue::takeUp(const std::vector<FoundPack>& found, Checks checks) {
  std::map<std::filesystem::path, File> next;
  bool changed = found.size() != files_.size();
  for (const FoundPack& pack : found) {
    const auto known = files_.find(pack.path);
    File file = known == files_.end() ? File{} : known->second;
    if (known == files_.end() || file.identity != pack.identity) {
      changed = true;
      file.identity = pack.identity;
      load(pack.path, file, checks);
    }
    next.emplace(pack.path, std::move(file));
  }
  for (const auto& [path, file] : files_)
    if (!next.contains(path)) spdlog::info("{}: removed", path.string());
  files_ = std::move(next);
  return changed;
}

void PackCatalogue::load(const std::filesystem::path& path, File& file, Checks checks) {
  auto store = openStore(path, checks);
  if (!store) {
    // A file that is being written comes by at every rescan, each time another one: say it once.
    if (file.problem != store.error().message)
      spdlog::warn("{}: {}: {}", path.string(),
                   file.store ? "left out, its former content stays in service" : "left out",
                   store.error().message);
    file.problem = store.error().message;
    const std::unique_lock lock(mutex_);
    ++counts_.failures;
    return;
  }
  file.store = std::move(*store);
  file.problem.clear();
  file.shadowed = false;
  const MeshMetadata& metadata = file.store->metadata();
  spdlog::info("{}: mesh {}, revision {}, {} triangles", path.string(), metadata.name,
               metadata.revision, metadata.triangleCount);
  const std::unique_lock lock(mutex_);
  ++counts_.loads;
}

Result<std::shared_ptr<PackStore>> PackCatalogue::openStore(const std::filesystem::path& path,
                                                            Checks checks) const {
  auto pack = Pack::open(path);
  if (!pack) return tl::unexpected(pack.error());
  auto store = std::make_shared<PackStore>(std::move(*pack), budget_, options_.indexes);
  if (checks == Checks::directory)
    if (const auto level = store->maxLevel(); !level) return tl::unexpected(level.error());
  return store;
}

PackCatalogue::Meshes PackCatalogue::meshesOfFiles() {
  Meshes meshes;
  for (auto& [path, file] : files_) {
    if (!file.store) continue;
    const MeshMetadata& metadata = file.store->metadata();
    const bool isFirst = meshes.try_emplace(metadata.name, Mesh{file.store, {}}).second;
    if (!isFirst && !file.shadowed)
      spdlog::warn("{}: left out: another pack holds mesh {} already", path.string(),
                   metadata.name);
    file.shadowed = !isFirst;
  }
  return meshes;
}

void PackCatalogue::publish() {
  Meshes meshes = meshesOfFiles();
  std::vector<MeshMetadata> described;
  described.reserve(meshes.size());
  for (auto& [name, mesh] : meshes) {
    described.push_back(mesh.store->metadata());
    mesh.json = HeldBytes::of(toJson(described.back()));
  }
  HeldBytes list = HeldBytes::of(catalogueJson(described));
  const auto broken = static_cast<size_t>(std::count_if(
      files_.begin(), files_.end(), [](const auto& file) { return !file.second.problem.empty(); }));

  std::vector<Retired> dropped;  // destroyed after the lock is given up
  const std::unique_lock lock(mutex_);
  meshes_.swap(meshes);
  list_ = std::move(list);
  counts_.brokenFiles = broken;
  retire(meshes, dropped);
}

void PackCatalogue::retire(const Meshes& old, std::vector<Retired>& dropped) {
  const auto now = Clock::now();
  const auto isCurrent = [&](const PackStore& store) {
    const auto it = meshes_.find(store.metadata().name);
    return it != meshes_.end() &&
           it->second.store->metadata().revision == store.metadata().revision;
  };
  for (const auto& [name, mesh] : old)
    if (!isCurrent(*mesh.store)) retired_.push_back({mesh.store, now + options_.grace});
  const size_t tooMany =
      retired_.size() > options_.maxRetired ? retired_.size() - options_.maxRetired : 0;
  std::vector<Retired> kept;
  for (size_t i = 0; i < retired_.size(); ++i) {
    // A revision that has come back is current and no longer needs its old file.
    const bool ends = i < tooMany || retired_[i].until <= now || isCurrent(*retired_[i].store);
    (ends ? dropped : kept).push_back(std::move(retired_[i]));
  }
  retired_ = std::move(kept);
}

PackCatalogue::Statistics PackCatalogue::statistics() const {
  const std::shared_lock lock(mutex_);
  Statistics statistics = counts_;
  statistics.meshes = meshes_.size();
  statistics.retired = retired_.size();
  return statistics;
}

Result<Described> PackCatalogue::list(Waiting) {
  const std::shared_lock lock(mutex_);
  return Described{list_, std::nullopt};
}

Result<Described> PackCatalogue::describe(std::string_view mesh, Waiting) {
  const std::shared_lock lock(mutex_);
  const auto it = meshes_.find(mesh);
  if (it == meshes_.end()) return fail(ErrorCode::notFound, "no mesh of that name");
  return Described{it->second.json, std::nullopt};
}

Result<std::shared_ptr<RecordStore>> PackCatalogue::open(std::string_view mesh,
                                                         std::string_view revision, Waiting) {
  const std::shared_lock lock(mutex_);
  const auto it = meshes_.find(mesh);
  if (it != meshes_.end() && it->second.store->metadata().revision == revision)
    return it->second.store;
  for (const Retired& old : retired_)
    if (old.store->metadata().revision == revision && old.store->metadata().name == mesh)
      return old.store;
  if (it == meshes_.end()) return fail(ErrorCode::notFound, "no mesh of that name");
  return fail(ErrorCode::notFound, "no such revision; ask for the mesh's current one");
}

}  // namespace meshfront
