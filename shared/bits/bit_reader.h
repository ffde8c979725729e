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
  [[nodiscard]] uint64_t peek(unsigned count) {
    if (count > ready_) refill();
    return window_ >> 1 >> (63 - count);
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
      return;
    }
    position_ += count;
    if (count < ready_) {
      window_ <<= count;
      ready_ -= static_cast<unsigned>(count);
    } else {
      ready_ = 0;
    }
  }

  // The next bits, from the highest one on, and how many they are: 57 or all that are left at
  // least.
  [[nodiscard]] uint64_t window() {
    if (ready_ < 57) refill();
    return window_;
  }
  [[nodiscard]] unsigned windowBits() const {
    return static_cast<unsigned>(ready_ < left() ? ready_ : left());
  }

  [[nodiscard]] uint64_t position() const { return position_; }
  [[nodiscard]] uint64_t end() const { return end_; }
  [[nodiscard]] uint64_t left() const { return end_ - position_; }
  [[nodiscard]] bool overrun() const { return overrun_; }
  // For decoders that meet an impossible value: same sticky state as reading past the end.
  void fail() {
    overrun_ = true;
    position_ = end_;
    window_ = 0;
    ready_ = 64;
  }

 private:
  void refill() {
    const auto inByte = static_cast<unsigned>(position_ & 7);
    window_ = load(position_ >> 3) << inByte;
    ready_ = 64 - inByte;
    const uint64_t left = end_ - position_;
    if (left < 64) window_ = left == 0 ? 0 : window_ >> (64 - left) << (64 - left);
  }
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
  uint64_t window_ = 0;  // the next bits, from the highest one on, zeros beyond the end
  unsigned ready_ = 0;   // how many of them
  bool overrun_ = false;
};

// Reads as BitReader does, from a window of one: in registers, without looking at memory. Whoever
// uses it asks in the end whether the window sufficed, and else takes the BitReader.
class BitWindow {
 public:
  explicit BitWindow(BitReader& in) : bits_(in.window()), valid_(in.windowBits()) {}
  [[nodiscard]] uint64_t peek(unsigned count) const {  // 0..63
    return bits_ >> 1 >> (63 - count);
  }
  uint64_t read(unsigned count) {
    const uint64_t value = peek(count);
    skip(count);
    return value;
  }
  bool readBit() { return read(1) != 0; }
  void skip(unsigned count) {  // 0..63
    bits_ <<= count;
    used_ += count;
  }
  void fail() { used_ = UINT32_MAX / 2; }

  [[nodiscard]] unsigned used() const { return used_; }
  [[nodiscard]] bool sufficed() const { return used_ <= valid_; }

 private:
  uint64_t bits_;
  unsigned valid_;
  unsigned used_ = 0;
};

}  // namespace meshfront
