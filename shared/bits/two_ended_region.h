// Two sequences of binary decisions in one short string of bits: one is read from its front, the
// other from its back. Both are arithmetic codes (Rissanen and Langdon, Arithmetic coding, IBM
// Journal of Research and Development 23(2), 1979), and behind the string's far end a reader sees
// zeros. So a reader may stop after any prefix of either sequence, the two codes may share bits,
// and what a string of this length cannot be wrong about is not written.
//
//   TwoEndedReader in(bytes, begin, end);
//   const bool bit = in.forward(48);     // 0 has a chance of 48 in 64
//
//   TwoEndedWriter out;                  // the decisions in reading order
//   out.forward().encode(bit, 48);
//   const auto region = out.ofLength(out.shortestLength());
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/bits/bit_reader.h"
#include "shared/bits/bit_writer.h"

namespace meshfront {

// Chances of a zero are 1 .. 63 in 64.
inline constexpr unsigned kChanceBits = 6;
inline constexpr unsigned kEvenChance = 1U << (kChanceBits - 1);

// The bits of a word in the other order.
[[nodiscard]] inline uint64_t reversedWord(uint64_t v) {
  v = (v >> 1 & 0x5555555555555555ULL) | (v & 0x5555555555555555ULL) << 1;
  v = (v >> 2 & 0x3333333333333333ULL) | (v & 0x3333333333333333ULL) << 2;
  v = (v >> 4 & 0x0F0F0F0F0F0F0F0FULL) | (v & 0x0F0F0F0F0F0F0F0FULL) << 4;
  return __builtin_bswap64(v);
}

// The decisions of one direction. Any bits decode to something: there is no damage to notice here.
class DecisionReader {
 public:
  DecisionReader() = default;
  // Of a word, from the highest bit on, with zeros behind it.
  explicit DecisionReader(uint64_t bits)
      : next_(bits << 32), value_(bits >> 32), ready_(kEndless) {}
  // Reads bits [begin, end) of `bytes`, from `end` down if backward. begin <= end <= all bits.
  DecisionReader(std::span<const uint8_t> bytes, uint64_t begin, uint64_t end, bool backward)
      : bytes_(bytes), begin_(begin), end_(end), backward_(backward) {
    refill();
    value_ = next_ >> 32;
    advance(32);
  }
  bool decide(unsigned chanceOfZero) {
    const uint64_t bound = (range_ >> kChanceBits) * chanceOfZero;
    const bool bit = value_ >= bound;
    // Without a branch, since nobody can guess it.
    const uint64_t whenSet = bit ? ~uint64_t{0} : 0;
    value_ -= bound & whenSet;
    range_ = bound + ((range_ - 2 * bound) & whenSet);
    // A chance of 1 in 64 at least leaves a range that one step makes large enough.
    if (range_ < kLeastRange) {
      if (ready_ < 8) refill();
      value_ = value_ << 8 | next_ >> 56;
      advance(8);
      range_ <<= 8;
    }
    return bit;
  }

 private:
  friend class DecisionWriter;
  static constexpr uint64_t kWholeRange = uint64_t{1} << 32;
  static constexpr uint64_t kLeastRange = uint64_t{1} << 24;
  static constexpr unsigned kEndless = 1U << 30;  // more bits than anybody asks for

  void advance(unsigned count) {
    next_ <<= count;
    ready_ -= count;
  }
  void refill();

  std::span<const uint8_t> bytes_;
  uint64_t begin_ = 0;  // of the bits that are not in next_
  uint64_t end_ = 0;
  uint64_t next_ = 0;  // from the highest bit on, zeros behind `ready_`
  uint64_t value_ = 0;
  uint64_t range_ = kWholeRange;
  unsigned ready_ = 0;
  bool backward_ = false;
};

class TwoEndedReader {
 public:
  TwoEndedReader(std::span<const uint8_t> bytes, uint64_t begin, uint64_t end)
      : bytes_(bytes), begin_(begin), end_(end) {
    if (isShort()) {
      word_ = BitReader(bytes, begin, end).window();
      forward_ = DecisionReader(word_);
    } else {
      forward_ = DecisionReader(bytes, begin, end, false);
    }
  }
  bool forward(unsigned chanceOfZero) { return forward_.decide(chanceOfZero); }
  bool backward(unsigned chanceOfZero) {
    if (!started_) {
      started_ = true;
      backward_ = isShort() ? DecisionReader(reversedWord(word_ >> 1) << (63 - (end_ - begin_)))
                            : DecisionReader(bytes_, begin_, end_, true);
    }
    return backward_.decide(chanceOfZero);
  }

 private:
  // Nearly all are; a word holds them.
  [[nodiscard]] bool isShort() const { return end_ - begin_ <= 56; }

  DecisionReader forward_;
  DecisionReader backward_;
  std::span<const uint8_t> bytes_;
  uint64_t begin_;
  uint64_t end_;
  uint64_t word_ = 0;  // of a short one, from the highest bit on
  bool started_ = false;
};

// The set of bit strings that decode to the decisions so far: an interval of numbers in [0, 1).
class DecisionWriter {
 public:
  void encode(bool bit, unsigned chanceOfZero);
  void clear();

  // Strings of `length` bits that decode to the decisions: the numbers in [begin, end), if any.
  // Only if compact(), length <= 56.
  struct Strings {
    uint64_t begin = 0;
    uint64_t end = 0;
  };
  [[nodiscard]] Strings strings(unsigned length) const;
  [[nodiscard]] bool compact() const { return prefix_.size() <= 3; }
  // The fewest leading bits that decide everything, whatever follows them.
  [[nodiscard]] std::vector<bool> whole() const;
  [[nodiscard]] unsigned wholeLength() const;

 private:
  // The digits behind prefix_, of which the last `free` may be anything; as many as can be.
  struct FreeDigits {
    uint64_t first;
    unsigned free;
  };
  [[nodiscard]] FreeDigits freeDigits() const;

  std::vector<uint8_t> prefix_;  // the interval's begin, above `low_`
  uint64_t low_ = 0;             // below 2^32
  uint64_t range_ = uint64_t{1} << 32;
};

class TwoEndedWriter {
 public:
  [[nodiscard]] DecisionWriter& forward() { return forward_; }
  [[nodiscard]] DecisionWriter& backward() { return backward_; }
  void clear();

  using Region = std::vector<bool>;
  // Length of the shortest region found; at least 1. Deterministic.
  [[nodiscard]] unsigned shortestLength() const;
  // A region of just that many bits; none if no string of that length was found. There is one for
  // every length from safeLength() on.
  [[nodiscard]] std::optional<Region> ofLength(unsigned length) const;
  // The bits of both directions, if none is shared.
  [[nodiscard]] unsigned safeLength() const;

 private:
  // The smallest string that both directions accept, if it is cheap to find.
  [[nodiscard]] std::optional<uint64_t> shared(unsigned length) const;

  DecisionWriter forward_;
  DecisionWriter backward_;
};

}  // namespace meshfront
