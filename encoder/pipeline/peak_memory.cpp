#include "encoder/pipeline/peak_memory.h"

#include <charconv>
#include <fstream>
#include <string>
#include <string_view>

namespace meshfront {

uint64_t peakMemory() {
  constexpr uint64_t kKibi = 1024;
  constexpr std::string_view kKey = "VmHWM:";
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (!line.starts_with(kKey)) continue;
    const size_t digits = line.find_first_of("0123456789");
    if (digits == std::string::npos) return 0;
    uint64_t value = 0;
    std::from_chars(line.data() + digits, line.data() + line.size(), value);
    return value * kKibi;
  }
  return 0;
}

void forgetPeakMemory() {
  std::ofstream("/proc/self/clear_refs") << "5";
}

}  // namespace meshfront
