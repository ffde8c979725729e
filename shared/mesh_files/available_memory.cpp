#include "shared/mesh_files/available_memory.h"

#include <sys/resource.h>

#include <charconv>
#include <fstream>
#include <optional>
#include <string_view>

namespace meshfront {

namespace {

namespace fs = std::filesystem;

std::optional<uint64_t> leadingNumber(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  uint64_t value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc()) return std::nullopt;
  return value;
}

// The number behind `key` at the start of a line.
std::optional<uint64_t> field(const fs::path& file, std::string_view key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.size() > key.size() && std::string_view(line).starts_with(key)) {
      if (const auto value = leadingNumber(std::string_view(line).substr(key.size()))) return value;
    }
  }
  return std::nullopt;
}

std::optional<uint64_t> number(const fs::path& file) {
  return field(file, "");
}

// The names that the two versions of control groups have for the same things.
struct GroupFiles {
  const char* limit;
  const char* use;
  const char* droppable;  // a line of memory.stat
};
constexpr GroupFiles kVersion1 = {"memory.limit_in_bytes", "memory.usage_in_bytes",
                                  "total_inactive_file "};
constexpr GroupFiles kVersion2 = {"memory.max", "memory.current", "inactive_file "};

void lower(AvailableMemory& least, uint64_t bytes, const char* limitedBy) {
  if (bytes < least.bytes) least = {bytes, limitedBy};
}

// A group and all that it lies in. In a container the group's path may be the host's; then only
// the top is there.
void applyGroups(const fs::path& mount, std::string group, const GroupFiles& files,
                 AvailableMemory& least) {
  for (;;) {
    const fs::path folder = mount / fs::path(group).relative_path();
    const auto limit = number(folder / files.limit);  // none: "max", or no such group
    const auto use = number(folder / files.use);
    if (limit && use) {
      const uint64_t droppable = field(folder / "memory.stat", files.droppable).value_or(0);
      const uint64_t held = *use > droppable ? *use - droppable : 0;
      lower(least, *limit > held ? *limit - held : 0, "the limit of its control group");
    }
    if (group.empty()) return;
    group.resize(group.rfind('/') == std::string::npos ? 0 : group.rfind('/'));
  }
}

}  // namespace

AvailableMemory availableMemory(const std::filesystem::path& root) {
  constexpr uint64_t kKibi = 1024;
  AvailableMemory least;
  if (const auto free = field(root / "proc/meminfo", "MemAvailable:"))
    lower(least, *free * kKibi, "the machine's free memory");

  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {  // number:controllers:/path
    const size_t first = line.find(':');
    const size_t second = first == std::string::npos ? first : line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const std::string group = line.substr(second + 1);
    if (controllers.empty()) applyGroups(root / "sys/fs/cgroup", group, kVersion2, least);
    if (("," + controllers + ",").find(",memory,") != std::string::npos)
      applyGroups(root / "sys/fs/cgroup/memory", group, kVersion1, least);
  }

  rlimit space{};
  if (getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY) {
    const uint64_t used = field(root / "proc/self/status", "VmSize:").value_or(0) * kKibi;
    lower(least, space.rlim_cur > used ? space.rlim_cur - used : 0,
          "the limit on address space (ulimit -v)");
  }
  return least;
}

}  // namespace meshfront
