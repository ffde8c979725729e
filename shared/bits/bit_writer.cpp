#include "shared/bits/bit_writer.h"

#include <algorithm>

#include "shared/bits/bit_reader.h"

namespace meshfront {

void BitWriter::appendLong(std::span<const uint8_t> source, uint64_t bitOffset, uint64_t bitCount) {
  BitReader reader(source, bitOffset, bitOffset + bitCount);
  while (bitCount > 0) {
    const auto step = static_cast<unsigned>(std::min<uint64_t>(bitCount, 56));
    write(reader.read(step), step);
    bitCount -= step;
  }
}

void BitWriter::appendPending(std::vector<uint8_t>& out) const {
  for (unsigned bits = 0; bits < pendingBits_; bits += 8)
    out.push_back(static_cast<uint8_t>(pending_ >> (56 - bits)));
}

std::vector<uint8_t> BitWriter::take() {
  appendPending(bytes_);
  std::vector<uint8_t> out = std::move(bytes_);
  clear();
  return out;
}

std::vector<uint8_t> BitWriter::padded() const {
  std::vector<uint8_t> out = bytes_;
  appendPending(out);
  return out;
}

void BitWriter::clear() {
  bytes_.clear();
  pending_ = 0;
  pendingBits_ = 0;
}

}  // namespace meshfront
