// How much memory this process may still take, before it is ended for taking too much.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace meshfront {

struct AvailableMemory {
  uint64_t bytes = UINT64_MAX;  // unknown: no limit
  std::string limitedBy;        // what sets the limit, for people: "the machine", ...
};

// The least of: MemAvailable of the kernel; limit minus use of the process's control groups
// (version 2 and 1, with all that they lie in; pages of files that could be dropped count as free);
// RLIMIT_AS minus the address space in use. Swap does not count. `root` is where /proc and /sys
// lie, for tests; what cannot be read there sets no limit.
[[nodiscard]] AvailableMemory availableMemory(const std::filesystem::path& root = "/");

}  // namespace meshfront
