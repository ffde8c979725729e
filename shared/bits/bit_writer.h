// Appends bits, most significant first, to a byte vector.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace meshfront {

class BitWriter {
 public:
  // Appends the low `count` bits of `value` (count 0..57), high bit first.
  void write(uint64_t value, unsigned count) {
    if (count == 0) return;
    value &= (uint64_t{1} << count) - 1;
    const unsigned room = 64 - pendingBits_;
    if (count < room) {
      pending_ |= value << (room - count);
      pendingBits_ += count;
      return;
    }
    const unsigned rest = count - room;
    flush(pending_ | value >> rest);
    pending_ = rest > 0 ? value << (64 - rest) : 0;
    pendingBits_ = rest;
  }
  void writeBit(bool bit) { write(bit ? 1 : 0, 1); }

  // Appends `bitCount` bits of `source`, beginning at its bit `bitOffset`. The range must lie
  // inside.
  void append(std::span<const uint8_t> source, uint64_t bitOffset, uint64_t bitCount) {
    const uint64_t first = bitOffset >> 3;
    if (bitCount - 1 >= 57 || first + 8 > source.size())
      return appendLong(source, bitOffset, bitCount);
    uint64_t word = 0;
    std::memcpy(&word, source.data() + first, 8);
    word = __builtin_bswap64(word) << (bitOffset & 7);
    write(word >> (64 - bitCount), static_cast<unsigned>(bitCount));
  }

  [[nodiscard]] uint64_t bitCount() const { return bytes_.size() * 8 + pendingBits_; }

  // Pads with zeros to a whole byte and hands the bytes over; the writer is empty afterwards.
  [[nodiscard]] std::vector<uint8_t> take();
  // The bytes so far, padded; the writer keeps its state.
  [[nodiscard]] std::vector<uint8_t> padded() const;
  void reserve(size_t bytes) { bytes_.reserve(bytes); }
  void clear();

 private:
  void flush(uint64_t word) {
    const size_t at = bytes_.size();
    bytes_.resize(at + 8);
    word = __builtin_bswap64(word);
    std::memcpy(bytes_.data() + at, &word, 8);
  }
  void appendLong(std::span<const uint8_t> source, uint64_t bitOffset, uint64_t bitCount);
  void appendPending(std::vector<uint8_t>& out) const;

  std::vector<uint8_t> bytes_;  // whole words
  uint64_t pending_ = 0;        // left-aligned
  unsigned pendingBits_ = 0;    // 0 .. 63
};

}  // namespace meshfront
