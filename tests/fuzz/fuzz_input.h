// An input taken apart from the front; zeros behind its end.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "shared/bits/crc32c.h"

namespace meshfront::fuzz {

class FuzzInput {
 public:
  explicit FuzzInput(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] bool empty() const { return bytes_.empty(); }
  [[nodiscard]] std::span<const uint8_t> rest() const { return bytes_; }
  uint8_t byte() { return bytes_.empty() ? 0 : take(1)[0]; }
  uint16_t word() {  // little-endian
    const unsigned low = byte();
    return static_cast<uint16_t>(low | unsigned{byte()} << 8);
  }
  std::span<const uint8_t> take(size_t count) {
    const auto taken = bytes_.first(std::min(count, bytes_.size()));
    bytes_ = bytes_.subspan(taken.size());
    return taken;
  }
  // Up to and without the next line feed, which is taken too.
  std::string_view line() {
    const auto end = std::find(bytes_.begin(), bytes_.end(), '\n');
    const auto taken = take(static_cast<size_t>(end - bytes_.begin()));
    take(1);
    return {reinterpret_cast<const char*>(taken.data()), taken.size()};
  }

 private:
  std::span<const uint8_t> bytes_;
};

[[nodiscard]] inline std::vector<uint8_t> withChecksum(std::span<const uint8_t> content) {
  std::vector<uint8_t> bytes(content.begin(), content.end());
  appendChecksum(bytes);
  return bytes;
}

}  // namespace meshfront::fuzz
