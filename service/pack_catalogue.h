// The catalogue of the packs in a folder: every file *.pack, which may come, be replaced and go
// while requests are answered.
//
// What happens to a file, and what rescan() makes of it:
//   new        its mesh is offered
//   replaced   (another inode, size or time) the mesh's new revision is offered; the old one stays
//              answerable under its own URLs for the grace period, for receivers in the midst of it
//   removed    the mesh leaves the catalogue; its revision stays answerable likewise
//   broken     said once in the log, counted until mended; what was in service stays so
//   second     of a name: left out while the first one, by file name, is there
// Whoever changes a pack writes a new file and renames it into place, as the encoder does: a file
// that is cut short while it is mapped cannot be read safely by anybody.
//
// Locking: scanning_ serialises rescans and guards files_; mutex_ guards what requests see and is
// held for a look-up or a swap, never while a file is touched. A request keeps the store that it
// was given, so it finishes on that revision whatever is swapped meanwhile.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <vector>

#include "service/pack_files.h"
#include "shared/http/catalogue.h"
#include "shared/store/memory_budget.h"
#include "shared/store/pack_store.h"

namespace meshfront {

class PackCatalogue final : public Catalogue {
 public:
  using Clock = std::chrono::steady_clock;
  struct Options {
    std::chrono::milliseconds grace{60'000};  // see above; a rescan at or after its end drops it
    size_t maxRetired = 64;                   // old revisions at a time; the oldest go first
    // Counts what the indexes of all packs do.
    std::shared_ptr<IndexStatistics> indexes = std::make_shared<IndexStatistics>();
  };
  struct Statistics {
    size_t meshes = 0;
    size_t brokenFiles = 0;  // as they lie in the folder now
    size_t retired = 0;      // old revisions that are still answerable
    uint64_t loads = 0;      // packs taken up, those at the start included
    uint64_t failures = 0;   // packs that could not be taken up
    uint64_t lostScans = 0;  // times that the folder could not be read
  };

  // Packs that cannot be opened, and second packs of a name, are logged and left out; the names of
  // files mean nothing. An error where the folder cannot be read. Opening parses no more than the
  // metadata.
  [[nodiscard]] static Result<std::unique_ptr<PackCatalogue>> read(
      const std::filesystem::path& folder, std::shared_ptr<MemoryBudget> budget, Options options);
  [[nodiscard]] static Result<std::unique_ptr<PackCatalogue>> read(
      const std::filesystem::path& folder, std::shared_ptr<MemoryBudget> budget) {
    return read(folder, std::move(budget), Options{});
  }

  // Takes up what has changed in the folder. Unlike at the start, base mesh and chunk index of a
  // pack are decoded before it may replace anything. A folder that cannot be read changes nothing.
  void rescan();

  [[nodiscard]] size_t size() const { return statistics().meshes; }
  [[nodiscard]] Statistics statistics() const;

  [[nodiscard]] Result<Described> list(Waiting waiting) override;
  [[nodiscard]] Result<Described> describe(std::string_view mesh, Waiting waiting) override;
  [[nodiscard]] Result<std::shared_ptr<RecordStore>> open(std::string_view mesh,
                                                          std::string_view revision,
                                                          Waiting waiting) override;
  [[nodiscard]] bool ready(Waiting) override { return true; }

 private:
  struct File {
    FileIdentity identity;
    std::shared_ptr<PackStore> store;  // the last one that could be read; null: none yet
    std::string problem;               // of the file as it is now; empty: none
    bool shadowed = false;             // another file holds its mesh
  };
  struct Mesh {
    std::shared_ptr<PackStore> store;
    HeldBytes json;
  };
  struct Retired {
    std::shared_ptr<PackStore> store;
    Clock::time_point until;
  };
  using Meshes = std::map<std::string, Mesh, std::less<>>;
  enum class Checks { metadata, directory };

  PackCatalogue(std::filesystem::path folder, std::shared_ptr<MemoryBudget> budget, Options options)
      : folder_(std::move(folder)), budget_(std::move(budget)), options_(std::move(options)) {}
  // False where nothing has changed. Called with scanning_ held.
  bool takeUp(const std::vector<FoundPack>& found, Checks checks);
  void load(const std::filesystem::path& path, File& file, Checks checks);
  [[nodiscard]] Result<std::shared_ptr<PackStore>> openStore(const std::filesystem::path& path,
                                                             Checks checks) const;
  [[nodiscard]] Meshes meshesOfFiles();
  void publish();
  // Called with mutex_ held: moves what requests shall no longer see into `dropped`, which is to be
  // destroyed after the lock, since that unmaps files.
  void retire(const Meshes& old, std::vector<Retired>& dropped);

  const std::filesystem::path folder_;
  const std::shared_ptr<MemoryBudget> budget_;
  const Options options_;

  std::mutex scanning_;
  std::map<std::filesystem::path, File> files_;  // in the order in which they claim names
  bool folderLost_ = false;

  mutable std::shared_mutex mutex_;
  Meshes meshes_;
  HeldBytes list_;
  std::vector<Retired> retired_;  // oldest first
  Statistics counts_;             // but for meshes and retired, which are counted when asked for
};

}  // namespace meshfront
