#include "shared/bits/two_ended_region.h"

#include <algorithm>

namespace meshfront {
namespace {

constexpr unsigned kMaxShared = 56;   // longer regions share no bits
constexpr uint64_t kMostTried = 256;  // strings of one length

uint64_t reversed(uint64_t value, unsigned length) {
  uint64_t out = 0;
  for (unsigned i = 0; i < length; ++i) out |= (value >> i & 1) << (length - 1 - i);
  return out;
}

void carry(std::vector<uint8_t>& digits) {
  for (size_t i = digits.size(); i-- > 0 && ++digits[i] == 0;) {
  }
}

}  // namespace

// Fewer than 8 bits are left then; a word has room for 56 more.
void DecisionReader::refill() {
  const auto count = static_cast<unsigned>(std::min<uint64_t>(56, end_ - begin_));
  if (count > 0) {
    const uint64_t from = backward_ ? end_ - count : begin_;
    uint64_t bits = BitReader(bytes_, from, from + count).peek(count);
    if (backward_) {
      bits = reversedWord(bits) >> (64 - count);
      end_ -= count;
    } else {
      begin_ += count;
    }
    next_ |= bits << (64 - count) >> ready_;
    ready_ += count;
  }
  if (begin_ >= end_) ready_ = 64;  // zeros behind the far end are as good as bits
}

void DecisionWriter::encode(bool bit, unsigned chanceOfZero) {
  const uint64_t bound = (range_ >> kChanceBits) * chanceOfZero;
  if (bit) {
    low_ += bound;
    range_ -= bound;
  } else {
    range_ = bound;
  }
  if (low_ >> 32 != 0) {
    low_ &= 0xFFFFFFFFU;
    carry(prefix_);
  }
  while (range_ < DecisionReader::kLeastRange) {
    prefix_.push_back(static_cast<uint8_t>(low_ >> 24));
    low_ = (low_ & 0xFFFFFFU) << 8;
    range_ <<= 8;
  }
}

void DecisionWriter::clear() {
  prefix_.clear();
  low_ = 0;
  range_ = DecisionReader::kWholeRange;
}

DecisionWriter::Strings DecisionWriter::strings(unsigned length) const {
  uint64_t begin = 0;
  for (const uint8_t byte : prefix_) begin = begin << 8 | byte;
  begin = begin << 32 | low_;
  const uint64_t end = begin + range_;
  const auto digits = static_cast<unsigned>(32 + 8 * prefix_.size());
  if (length >= digits) return {begin << (length - digits), end << (length - digits)};
  const unsigned dropped = digits - length;
  const uint64_t up = (uint64_t{1} << dropped) - 1;
  return {(begin + up) >> dropped, (end + up) >> dropped};
}

DecisionWriter::FreeDigits DecisionWriter::freeDigits() const {
  for (unsigned free = 32;; --free) {
    const uint64_t step = uint64_t{1} << free;
    const uint64_t first = (low_ + step - 1) / step * step;
    if (first + step <= low_ + range_) return {first, free};
  }
}

unsigned DecisionWriter::wholeLength() const {
  return static_cast<unsigned>(8 * prefix_.size()) + 32 - freeDigits().free;
}

std::vector<bool> DecisionWriter::whole() const {
  const auto [first, free] = freeDigits();
  std::vector<uint8_t> prefix = prefix_;
  if (first >> 32 != 0) carry(prefix);
  std::vector<bool> out;
  for (const uint8_t byte : prefix)
    for (unsigned i = 8; i-- > 0;) out.push_back((byte >> i & 1) != 0);
  for (unsigned i = 32; i-- > free;) out.push_back((first >> i & 1) != 0);
  return out;
}

void TwoEndedWriter::clear() {
  forward_.clear();
  backward_.clear();
}

unsigned TwoEndedWriter::safeLength() const {
  return std::max(1U, forward_.wholeLength() + backward_.wholeLength());
}

std::optional<uint64_t> TwoEndedWriter::shared(unsigned length) const {
  if (length > kMaxShared || !forward_.compact() || !backward_.compact()) return std::nullopt;
  const auto front = forward_.strings(length);
  const auto back = backward_.strings(length);
  if (front.begin >= front.end || back.begin >= back.end) return std::nullopt;
  const auto holds = [](const DecisionWriter::Strings& set, uint64_t value) {
    return value >= set.begin && value < set.end;
  };
  if (front.end - front.begin <= back.end - back.begin) {
    const uint64_t end = std::min(front.end, front.begin + kMostTried);
    for (uint64_t x = front.begin; x < end; ++x)
      if (holds(back, reversed(x, length))) return x;
  } else {
    const uint64_t end = std::min(back.end, back.begin + kMostTried);
    for (uint64_t x = back.begin; x < end; ++x)
      if (holds(front, reversed(x, length))) return reversed(x, length);
  }
  return std::nullopt;
}

std::optional<TwoEndedWriter::Region> TwoEndedWriter::ofLength(unsigned length) const {
  if (const auto found = shared(length)) {
    Region region(length);
    for (unsigned i = 0; i < length; ++i) region[i] = (*found >> (length - 1 - i) & 1) != 0;
    return region;
  }
  const Region front = forward_.whole();
  const Region back = backward_.whole();
  if (length < front.size() + back.size()) return std::nullopt;
  Region region(length);
  std::copy(front.begin(), front.end(), region.begin());
  std::copy(back.rbegin(), back.rend(), region.end() - static_cast<ptrdiff_t>(back.size()));
  return region;
}

unsigned TwoEndedWriter::shortestLength() const {
  const unsigned safe = safeLength();
  for (unsigned length = 1; length < std::min(safe, kMaxShared); ++length)
    if (shared(length)) return length;
  return safe;
}

}  // namespace meshfront
