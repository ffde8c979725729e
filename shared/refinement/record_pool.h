// Bit strings of any length, kept one by one in blocks of eight bytes and given back one by one:
// the records that are too long to lie in their nodes. Freed blocks are used again, whole or in
// part.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/bits/bit_reader.h"
#include "shared/refinement/growing_array.h"

namespace meshfront {

class RecordPool {
 public:
  using Place = uint32_t;  // the first of its blocks
  static constexpr uint32_t kBlockBits = 64;

  // Bits [bitOffset, bitOffset + bitLength) of `source`, which must lie inside; bitLength > 0.
  Place keep(std::span<const uint8_t> source, uint64_t bitOffset, uint32_t bitLength);
  // `bitLength` as it was kept.
  void drop(Place place, uint32_t bitLength);
  // From the first bit on, zeros up to a whole block.
  [[nodiscard]] std::span<const uint8_t> bytes(Place place, uint32_t bitLength) const {
    return {reinterpret_cast<const uint8_t*>(blocks_.data() + place),
            size_t{blocksOf(bitLength)} * sizeof(uint64_t)};
  }
  [[nodiscard]] size_t memoryBytes() const {
    return blocks_.memoryBytes() + free_.capacity() * sizeof(uint32_t);
  }
  [[nodiscard]] size_t memoryBytesAfter(uint64_t bits) const {
    return memoryBytes() - blocks_.memoryBytes() +
           blocks_.memoryBytesFor(blocks_.size() + bits / kBlockBits + 1);
  }

  // `bitLength` bits, from the first one of `out` on, zeros behind them up to out's end. `out` is
  // whole blocks.
  static void copyBits(std::span<const uint8_t> source, uint64_t bitOffset, uint32_t bitLength,
                       std::span<uint8_t> out);

 private:
  static constexpr uint32_t kNoPlace = UINT32_MAX;
  [[nodiscard]] static uint32_t blocksOf(uint32_t bits) {
    return static_cast<uint32_t>((uint64_t{bits} + kBlockBits - 1) / kBlockBits);
  }
  void addFree(Place place, uint32_t blocks);

  GrowingArray<uint64_t> blocks_;
  std::vector<Place> free_;  // by number of blocks: the first of a list, linked by first blocks
};

}  // namespace meshfront
