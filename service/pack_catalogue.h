// The catalogue of the packs in a folder: every file *.pack, read once at the start.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "shared/http/catalogue.h"
#include "shared/store/memory_budget.h"
#include "shared/store/pack_store.h"

namespace meshfront {

class PackCatalogue final : public Catalogue {
 public:
  // Packs that cannot be opened, and second packs of a name, are logged and skipped; the names of
  // files mean nothing. An error where the folder cannot be read.
  [[nodiscard]] static Result<std::unique_ptr<PackCatalogue>> read(
      const std::filesystem::path& folder, std::shared_ptr<MemoryBudget> budget);

  [[nodiscard]] size_t size() const { return meshes_.size(); }

  [[nodiscard]] Result<Described> list(Waiting waiting) override;
  [[nodiscard]] Result<Described> describe(std::string_view mesh, Waiting waiting) override;
  [[nodiscard]] Result<std::shared_ptr<RecordStore>> open(std::string_view mesh,
                                                          std::string_view revision,
                                                          Waiting waiting) override;
  [[nodiscard]] bool ready(Waiting) override { return true; }

 private:
  struct Mesh {
    std::shared_ptr<PackStore> store;
    HeldBytes json;
  };
  PackCatalogue() = default;
  void add(const std::filesystem::path& file, const std::shared_ptr<MemoryBudget>& budget);
  void describeAll();

  std::map<std::string, Mesh, std::less<>> meshes_;  // constant once read
  HeldBytes list_;
};

}  // namespace meshfront
