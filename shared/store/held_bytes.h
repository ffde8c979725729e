// Bytes together with whatever keeps them alive: a mapped file, a cache entry, a vector. Copying is
// cheap, and the bytes never change.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace meshfront {

class HeldBytes {
 public:
  HeldBytes() = default;
  HeldBytes(std::span<const uint8_t> bytes, std::shared_ptr<const void> owner)
      : bytes_(bytes), owner_(std::move(owner)) {}
  [[nodiscard]] static HeldBytes of(std::vector<uint8_t> content) {
    auto owner = std::make_shared<const std::vector<uint8_t>>(std::move(content));
    const std::span<const uint8_t> bytes(*owner);
    return {bytes, std::move(owner)};
  }
  [[nodiscard]] static HeldBytes of(std::string content) {
    auto owner = std::make_shared<const std::string>(std::move(content));
    const std::span bytes(reinterpret_cast<const uint8_t*>(owner->data()), owner->size());
    return {bytes, std::move(owner)};
  }

  [[nodiscard]] std::span<const uint8_t> bytes() const { return bytes_; }
  [[nodiscard]] size_t size() const { return bytes_.size(); }

 private:
  std::span<const uint8_t> bytes_;
  std::shared_ptr<const void> owner_;
};

}  // namespace meshfront
