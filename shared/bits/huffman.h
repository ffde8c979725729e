// Canonical, length-limited Huffman codes (package-merge, Larmore and Hirschberg 1990).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/bits/bit_reader.h"
#include "shared/bits/bit_writer.h"

namespace meshfront {

inline constexpr unsigned kMaxHuffmanLength = 15;

class HuffmanCode {
 public:
  HuffmanCode() = default;  // no symbols: reading fails

  // Optimal lengths for the counts; symbols never seen get no code. One symbol alone costs 0 bits.
  [[nodiscard]] static HuffmanCode fromCounts(std::span<const uint64_t> counts);
  // Wire form: code lengths, compactly; `symbols` is known to both ends.
  void writeTo(BitWriter& out) const;
  // Untrusted: an incomplete or over-full set of lengths fails the reader.
  [[nodiscard]] static HuffmanCode readFrom(BitReader& in, size_t symbols);

  [[nodiscard]] size_t symbols() const { return lengths_.size(); }
  [[nodiscard]] bool has(size_t symbol) const;
  [[nodiscard]] unsigned length(size_t symbol) const { return lengths_[symbol]; }

  // Bytes held beside the object itself.
  [[nodiscard]] size_t memoryBytes() const {
    return lengths_.capacity() + codes_.capacity() * sizeof(uint16_t) +
           table_.capacity() * sizeof(Entry) + order_.capacity() * sizeof(uint16_t);
  }

  void write(BitWriter& out, size_t symbol) const { out.write(codes_[symbol], lengths_[symbol]); }
  // Fails the reader (sticky) where there is no such code; then returns 0.
  template <typename Reader>
  [[nodiscard]] uint32_t read(Reader& in) const {
    Entry entry = table_[in.peek(kTableBits)];
    if (entry.length > kTableBits)
      entry = longEntry(static_cast<uint32_t>(in.peek(kMaxHuffmanLength)));
    if (entry.length > kMaxHuffmanLength) {
      in.fail();
      return 0;
    }
    in.skip(entry.length);
    return entry.symbol;
  }

 private:
  static constexpr unsigned kTableBits = 9;
  struct Entry {
    uint16_t symbol = 0;
    uint16_t length = kMaxHuffmanLength + 1;  // beyond the table: longEntry()
  };
  void build();
  // For the next kMaxHuffmanLength bits; a length beyond that where there is no such code.
  [[nodiscard]] Entry longEntry(uint32_t window) const;

  std::vector<uint8_t> lengths_;
  std::vector<uint16_t> codes_;
  int only_ = -1;  // the symbol of a code with one symbol
  std::vector<Entry> table_ = std::vector<Entry>(size_t{1} << kTableBits);
  // Canonical decoding beyond the table: first code and first index into order_ by length.
  std::array<uint32_t, kMaxHuffmanLength + 2> firstCode_{};
  std::array<uint32_t, kMaxHuffmanLength + 2> firstIndex_{};
  std::vector<uint16_t> order_;
};

}  // namespace meshfront
