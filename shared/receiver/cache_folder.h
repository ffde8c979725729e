// The folder of a disk cache, which any number of processes use at once:
//
//   DIR/lock                        held while something is made or deleted
//   DIR/NAME-DIGEST/                a mesh: its name, and the digest of its URL
//   DIR/NAME-DIGEST/metadata        a document
//   DIR/NAME-DIGEST/REVISION/       in-use (locked by each user; its time: when it was last used),
//                                   base, chunks (documents), segment-CHANCE (record_segment.h)
//
// The byte budget is over all of DIR. When it is met, what was used longest ago goes first: whole
// revisions that nobody has open, then segments that nobody has open. What somebody uses stays, and
// nothing more is written then.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/receiver/locked_file.h"
#include "shared/receiver/mesh_url.h"
#include "shared/result.h"

namespace meshfront {

class CacheFolder {
 public:
  // Makes nothing yet.
  CacheFolder(std::filesystem::path folder, uint64_t budget, const MeshUrl& url);

  [[nodiscard]] const std::filesystem::path& meshFolder() const { return meshFolder_; }
  [[nodiscard]] std::filesystem::path revisionFolder(const std::string& revision) const {
    return meshFolder_ / revision;
  }
  [[nodiscard]] uint64_t budget() const { return budget_; }

  // Makes the revision's folder and marks it as used now, and in use while the file stays open.
  [[nodiscard]] Result<LockedFile> enter(const std::string& revision) const;
  // The mesh's other revisions are the first to go from now on.
  void ageOthers(const std::string& revision) const;
  // Deletes until `bytes` more fit. False: they do not, all that is left is in use, or the folder
  // cannot be used. They are then this process's to write: others that ask at the same moment may
  // go beyond the budget by what they asked for.
  [[nodiscard]] bool makeRoom(uint64_t bytes) const;
  [[nodiscard]] uint64_t bytesUsed() const;

  // Documents: small files that are replaced as a whole, with a checksum. Errors name the cause.
  [[nodiscard]] static std::optional<std::vector<uint8_t>> readDocument(
      const std::filesystem::path& path);
  [[nodiscard]] Result<void> writeDocument(const std::filesystem::path& path,
                                           std::span<const uint8_t> content) const;

 private:
  [[nodiscard]] Result<LockedFile> lock() const;

  const std::filesystem::path folder_;
  const std::filesystem::path meshFolder_;
  const uint64_t budget_;
};

}  // namespace meshfront
