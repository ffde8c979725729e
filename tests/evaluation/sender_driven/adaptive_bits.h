// An arithmetic code of bits whose chances are learned on both ends as they go (Rissanen and
// Langdon 1979). Behind the end of the bytes a reader sees zeros, and any bytes decode to
// something.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace meshfront::evaluation {

// The mean of a chance that learns fast and one that learns slowly, of a zero, in 65536ths.
class AdaptiveChance {
 public:
  [[nodiscard]] uint32_t ofZero() const {  // 1 .. 32767, in 32768ths
    const uint32_t mean = (uint32_t{fast_} + slow_) >> 2;
    return mean < kLeast ? kLeast : mean > 32768 - kLeast ? 32768 - kLeast : mean;
  }
  void learn(bool bit) {
    fast_ = next(fast_, bit, 4);
    slow_ = next(slow_, bit, 7);
  }

 private:
  static constexpr uint32_t kLeast = 48;
  [[nodiscard]] static uint16_t next(uint16_t chance, bool bit, unsigned rate) {
    return static_cast<uint16_t>(bit ? chance - (chance >> rate)
                                     : chance + ((65535 - chance) >> rate));
  }
  uint16_t fast_ = 32768;
  uint16_t slow_ = 32768;
};

class AdaptiveBitWriter {
 public:
  // Appends to `out`, which nobody else changes meanwhile.
  explicit AdaptiveBitWriter(std::vector<uint8_t>& out) : out_(out) {}
  void write(bool bit, AdaptiveChance& chance) {
    const uint32_t bound = (range_ >> 15) * chance.ofZero();
    chance.learn(bit);
    if (bit) {
      low_ += bound;
      range_ -= bound;
      if (low_ >> 32 != 0) carry();
    } else {
      range_ = bound;
    }
    while (range_ < uint32_t{1} << 24) {
      out_.push_back(static_cast<uint8_t>(low_ >> 24));
      low_ = (low_ << 8) & UINT32_MAX;
      range_ <<= 8;
    }
  }
  // The fewest bytes that say all.
  void finish() {
    for (unsigned zeros = 32; zeros-- > 0;) {
      const uint64_t mask = (uint64_t{1} << zeros) - 1;
      const uint64_t value = (low_ + mask) & ~mask;
      if (value >= low_ + range_) continue;
      low_ = value;
      if (low_ >> 32 != 0) carry();
      break;
    }
    for (; low_ != 0; low_ = (low_ << 8) & UINT32_MAX)
      out_.push_back(static_cast<uint8_t>(low_ >> 24));
  }

 private:
  void carry() {
    low_ &= UINT32_MAX;
    for (size_t i = out_.size(); i-- > 0;)
      if (++out_[i] != 0) break;
  }
  std::vector<uint8_t>& out_;
  uint64_t low_ = 0;
  uint32_t range_ = UINT32_MAX;
};

class AdaptiveBitReader {
 public:
  explicit AdaptiveBitReader(std::span<const uint8_t> bytes) : bytes_(bytes) {
    for (int i = 0; i < 4; ++i) value_ = value_ << 8 | nextByte();
  }
  bool read(AdaptiveChance& chance) {
    const uint32_t bound = (range_ >> 15) * chance.ofZero();
    const bool bit = value_ >= bound;
    chance.learn(bit);
    if (bit) {
      value_ -= bound;
      range_ -= bound;
    } else {
      range_ = bound;
    }
    while (range_ < uint32_t{1} << 24) {
      value_ = value_ << 8 | nextByte();
      range_ <<= 8;
    }
    return bit;
  }

 private:
  uint32_t nextByte() { return at_ < bytes_.size() ? bytes_[at_++] : 0; }
  std::span<const uint8_t> bytes_;
  size_t at_ = 0;
  uint32_t value_ = 0;
  uint32_t range_ = UINT32_MAX;
};

}  // namespace meshfront::evaluation
