// Bits that are appended and read back at any time: the records that a receiver keeps.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/bits/bit_reader.h"

namespace meshfront {

class BitStore {
 public:
  // Appends bits [bitOffset, bitOffset + bitCount) of `source`; they must lie inside.
  void append(std::span<const uint8_t> source, uint64_t bitOffset, uint64_t bitCount) {
    BitReader in(source, bitOffset, bitOffset + bitCount);
    while (bitCount > 0) {
      const auto room = static_cast<unsigned>(8 - (size_ & 7));
      const auto step = static_cast<unsigned>(bitCount < room ? bitCount : room);
      if (room == 8) bytes_.push_back(0);
      bytes_.back() = static_cast<uint8_t>(bytes_.back() | in.read(step) << (room - step));
      size_ += step;
      bitCount -= step;
    }
  }
  [[nodiscard]] uint64_t bitCount() const { return size_; }
  [[nodiscard]] std::span<const uint8_t> bytes() const { return bytes_; }

 private:
  std::vector<uint8_t> bytes_;
  uint64_t size_ = 0;
};

}  // namespace meshfront
