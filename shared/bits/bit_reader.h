// Reads bits, most significant first, from bytes it does not own. Safe on untrusted input: a read
// past the end yields zeros and sets overrun(), which callers check once at the end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace meshfront {

class BitReader {
 public:
  BitReader() = default;
  explicit BitReader(std::span<const uint8_t> bytes) : BitReader(bytes, 0, bytes.size() * 8) {}
  // Reads bits [begin, end) of `bytes`; end is clipped to the span.
  BitReader(std::span<const uint8_t> bytes, uint64_t begin, uint64_t end)
      : bytes_(bytes), position_(begin), end_(end) {
    if (end_ > bytes.size() * 8) end_ = bytes.size() * 8;
    if (position_ > end_) fail();
  }

  // The next `count` bits (0..57) without consuming them; zeros beyond the end.
  [[nodiscard]] uint64_t peek(unsigned count) const {
    if (count == 0) return 0;
    const uint64_t word = load(position_ >> 3) << (position_ & 7);
    uint64_t value = word >> (64 - count);
    if (position_ + count > end_) {
      const uint64_t missing = position_ + count - end_;
      value = missing >= count ? 0 : value >> missing << missing;
    }
    return value;
  }
  uint64_t read(unsigned count) {
    const uint64_t value = peek(count);
    skip(count);
    return value;
  }
  bool readBit() { return read(1) != 0; }
  void skip(uint64_t count) {
    if (count > end_ - position_) {
      fail();
    } else {
      position_ += count;
    }
  }

  [[nodiscard]] uint64_t position() const { return position_; }
  [[nodiscard]] uint64_t end() const { return end_; }
  [[nodiscard]] uint64_t left() const { return end_ - position_; }
  [[nodiscard]] bool overrun() const { return overrun_; }
  // For decoders that meet an impossible value: same sticky state as reading past the end.
  void fail() {
    overrun_ = true;
    position_ = end_;
  }

 private:
  // Eight bytes from byte `at`, big-endian, zeros beyond the span.
  [[nodiscard]] uint64_t load(uint64_t at) const {
    if (at + 8 <= bytes_.size()) {
      uint64_t word = 0;
      std::memcpy(&word, bytes_.data() + at, 8);
      return __builtin_bswap64(word);
    }
    uint64_t word = 0;
    for (uint64_t i = 0; i < 8; ++i)
      word = word << 8 | (at + i < bytes_.size() ? bytes_[at + i] : 0U);
    return word;
  }

  std::span<const uint8_t> bytes_;
  uint64_t position_ = 0;
  uint64_t end_ = 0;
  bool overrun_ = false;
};

}  // namespace meshfront
