#include "shared/mesh_files/available_memory.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <string>

namespace meshfront {
namespace {

std::optional<uint64_t> numberIn(const char* path) {  // none: no such file, or "max"
  uint64_t number = 0;
  std::ifstream in(path);
  return in >> number ? std::optional(number) : std::nullopt;
}

}  // namespace

uint64_t availableMemory() {
  uint64_t available = UINT64_MAX;
  std::ifstream info("/proc/meminfo");
  for (std::string key; info >> key;) {
    uint64_t kilobytes = 0;
    if (key == "MemAvailable:" && info >> kilobytes) available = kilobytes * 1024;
  }
  // Inside a container its own group is mounted here. Its current use counts caches too, which the
  // kernel takes back, so this errs to the safe side.
  const auto limit = numberIn("/sys/fs/cgroup/memory.max");
  const auto used = numberIn("/sys/fs/cgroup/memory.current");
  if (limit && used) available = std::min(available, *limit - std::min(*limit, *used));
  return available;
}

}  // namespace meshfront
