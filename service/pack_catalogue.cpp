#include "service/pack_catalogue.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <vector>

namespace meshfront {

Result<std::unique_ptr<PackCatalogue>> PackCatalogue::read(const std::filesystem::path& folder,
                                                           std::shared_ptr<MemoryBudget> budget) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    const std::filesystem::path& path = it->path();
    if (path.extension() == ".pack" && path.filename().string().front() != '.')
      files.push_back(path);
  }
  if (error)
    return fail(ErrorCode::notFound,
                "the folder of packs " + folder.string() + ": " + error.message());
  std::sort(files.begin(), files.end());  // which of two packs with one name counts, is settled
  std::unique_ptr<PackCatalogue> catalogue(new PackCatalogue);
  for (const auto& file : files) catalogue->add(file, budget);
  catalogue->describeAll();
  return catalogue;
}

void PackCatalogue::add(const std::filesystem::path& file,
                        const std::shared_ptr<MemoryBudget>& budget) {
  auto pack = Pack::open(file);
  if (!pack) {
    spdlog::warn("{}: skipped: {}", file.string(), pack.error().message);
    return;
  }
  const MeshMetadata& metadata = (*pack)->metadata();
  if (meshes_.contains(metadata.name)) {
    spdlog::warn("{}: skipped: another pack holds mesh {} already", file.string(), metadata.name);
    return;
  }
  spdlog::info("{}: mesh {}, revision {}, {} triangles", file.string(), metadata.name,
               metadata.revision, metadata.triangleCount);
  meshes_.emplace(metadata.name, Mesh{std::make_shared<PackStore>(*pack, budget),
                                      HeldBytes::of(toJson(metadata))});
}

void PackCatalogue::describeAll() {
  std::vector<MeshMetadata> meshes;
  meshes.reserve(meshes_.size());
  for (const auto& [name, mesh] : meshes_) meshes.push_back(mesh.store->metadata());
  list_ = HeldBytes::of(catalogueJson(meshes));
}

Result<Described> PackCatalogue::list(Waiting) {
  return Described{list_, std::nullopt};
}

Result<Described> PackCatalogue::describe(std::string_view mesh, Waiting) {
  const auto it = meshes_.find(mesh);
  if (it == meshes_.end()) return fail(ErrorCode::notFound, "no mesh of that name");
  return Described{it->second.json, std::nullopt};
}

Result<std::shared_ptr<RecordStore>> PackCatalogue::open(std::string_view mesh,
                                                         std::string_view revision, Waiting) {
  const auto it = meshes_.find(mesh);
  if (it == meshes_.end()) return fail(ErrorCode::notFound, "no mesh of that name");
  if (it->second.store->metadata().revision != revision)
    return fail(ErrorCode::notFound, "no such revision; ask for the mesh's current one");
  return it->second.store;
}

}  // namespace meshfront
