// Cut symbols of all splits, a few bytes each, between the pass that counts them and the one that
// writes them.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/codec/cut_coding.h"

namespace meshfront {

class CutArchive {
 public:
  void append(const CutSymbols& cut) {
    put(static_cast<uint32_t>(cut.symbols.size()));
    for (const auto& s : cut.symbols) {
      bytes_.push_back(
          static_cast<uint8_t>(static_cast<unsigned>(s.kind) << 1 | (s.leftFirst ? 1U : 0U)));
      put(s.runs);
      put(s.pair.left);
      put(s.pair.right);
    }
  }
  // Reads the splits back in the order appended; `position` starts at 0.
  void read(size_t& position, CutSymbols& out) const {
    out.symbols.resize(get(position));
    for (auto& s : out.symbols) {
      const uint8_t head = bytes_[position++];
      s.kind = static_cast<CutSymbols::Kind>(head >> 1);
      s.leftFirst = (head & 1) != 0;
      s.runs = get(position);
      s.pair.left = get(position);
      s.pair.right = get(position);
    }
  }

 private:
  void put(uint32_t value) {
    for (; value >= 128; value >>= 7) bytes_.push_back(static_cast<uint8_t>(value | 128));
    bytes_.push_back(static_cast<uint8_t>(value));
  }
  [[nodiscard]] uint32_t get(size_t& position) const {
    uint32_t value = 0;
    for (unsigned shift = 0;; shift += 7) {
      const uint8_t byte = bytes_[position++];
      value |= static_cast<uint32_t>(byte & 127) << shift;
      if (byte < 128) return value;
    }
  }
  std::vector<uint8_t> bytes_;
};

}  // namespace meshfront
