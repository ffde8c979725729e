// Appends bits, most significant first, to a byte vector.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace meshfront {

class BitWriter {
 public:
  // Appends the low `count` bits of `value` (count 0..57), high bit first.
  void write(uint64_t value, unsigned count) {
    if (count == 0) return;
    value &= (uint64_t{1} << count) - 1;
    pending_ |= value << (64 - pendingBits_ - count);
    pendingBits_ += count;
    while (pendingBits_ >= 8) {
      bytes_.push_back(static_cast<uint8_t>(pending_ >> 56));
      pending_ <<= 8;
      pendingBits_ -= 8;
    }
  }
  void writeBit(bool bit) { write(bit ? 1 : 0, 1); }

  // Appends `bitCount` bits of `source`, beginning at its bit `bitOffset`. The range must lie
  // inside.
  void append(std::span<const uint8_t> source, uint64_t bitOffset, uint64_t bitCount);

  [[nodiscard]] uint64_t bitCount() const { return bytes_.size() * 8 + pendingBits_; }

  // Pads with zeros to a whole byte and hands the bytes over; the writer is empty afterwards.
  [[nodiscard]] std::vector<uint8_t> take();
  // The bytes so far, padded; the writer keeps its state.
  [[nodiscard]] std::vector<uint8_t> padded() const;
  void reserve(size_t bytes) { bytes_.reserve(bytes); }
  void clear();

 private:
  std::vector<uint8_t> bytes_;
  uint64_t pending_ = 0;  // left-aligned
  unsigned pendingBits_ = 0;
};

}  // namespace meshfront
