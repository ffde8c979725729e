// The pack files of a folder, and how to tell that one of them is another one now.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "shared/result.h"

namespace meshfront {

// Differs whenever a file was replaced or written to, as far as the file system tells.
struct FileIdentity {
  uint64_t device = 0;
  uint64_t inode = 0;
  uint64_t size = 0;     // bytes
  int64_t modified = 0;  // ns since 1970
  int64_t changed = 0;   // likewise, of the inode: a rename into place counts

  bool operator==(const FileIdentity&) const = default;
};

struct FoundPack {
  std::filesystem::path path;
  FileIdentity identity;
};

// Every *.pack that is not hidden, by name. Files that go meanwhile are left out; an error where
// the folder itself cannot be read. Links are followed.
[[nodiscard]] Result<std::vector<FoundPack>> findPacks(const std::filesystem::path& folder);

}  // namespace meshfront
