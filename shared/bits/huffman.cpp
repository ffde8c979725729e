#include "shared/bits/huffman.h"

#include <algorithm>
#include <numeric>

#include "shared/bits/integer_codes.h"

namespace meshfront {
namespace {

constexpr unsigned kCountOrder = 3;  // Exp-Golomb order of the number of used symbols

// Package-merge: optimal code lengths of at most kMaxHuffmanLength for positive weights.
std::vector<uint8_t> packageMerge(const std::vector<uint64_t>& weights) {
  struct Package {
    uint64_t weight;
    std::vector<uint16_t> members;
  };
  std::vector<Package> leaves;
  for (size_t i = 0; i < weights.size(); ++i)
    leaves.push_back({weights[i], {static_cast<uint16_t>(i)}});
  std::stable_sort(leaves.begin(), leaves.end(),
                   [](const Package& a, const Package& b) { return a.weight < b.weight; });
  std::vector<Package> row = leaves;
  for (unsigned level = 1; level < kMaxHuffmanLength; ++level) {
    std::vector<Package> paired;
    for (size_t i = 0; i + 1 < row.size(); i += 2) {
      Package both{row[i].weight + row[i + 1].weight, row[i].members};
      both.members.insert(both.members.end(), row[i + 1].members.begin(), row[i + 1].members.end());
      paired.push_back(std::move(both));
    }
    row.clear();
    std::merge(leaves.begin(), leaves.end(), paired.begin(), paired.end(), std::back_inserter(row),
               [](const Package& a, const Package& b) { return a.weight < b.weight; });
  }
  std::vector<uint8_t> lengths(weights.size());
  for (size_t i = 0; i < 2 * weights.size() - 2; ++i)
    for (const uint16_t member : row[i].members) ++lengths[member];
  return lengths;
}

uint64_t zigzag(int value) {
  return value < 0 ? static_cast<uint64_t>(-2 * value - 1) : static_cast<uint64_t>(2 * value);
}
int unzigzag(uint64_t value) {
  return (value & 1) != 0 ? -static_cast<int>(value / 2) - 1 : static_cast<int>(value / 2);
}

}  // namespace

HuffmanCode HuffmanCode::fromCounts(std::span<const uint64_t> counts) {
  HuffmanCode code;
  code.lengths_.assign(counts.size(), 0);
  std::vector<size_t> used;
  std::vector<uint64_t> weights;
  for (size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    used.push_back(i);
    weights.push_back(counts[i]);
  }
  if (used.size() == 1) {
    code.only_ = static_cast<int>(used[0]);
  } else if (used.size() > 1) {
    const auto lengths = packageMerge(weights);
    for (size_t i = 0; i < used.size(); ++i) code.lengths_[used[i]] = lengths[i];
  }
  code.build();
  return code;
}

void HuffmanCode::writeTo(BitWriter& out) const {
  const auto used = only_ >= 0 ? 1
                               : std::count_if(lengths_.begin(), lengths_.end(),
                                               [](uint8_t length) { return length > 0; });
  writeExpGolomb(out, static_cast<uint64_t>(used), kCountOrder);
  if (only_ >= 0) {
    writeExpGolomb(out, static_cast<uint64_t>(only_), kCountOrder);
    return;
  }
  uint64_t gap = 0;
  int last = 4;
  for (const uint8_t length : lengths_) {
    if (length == 0) {
      ++gap;
      continue;
    }
    writeExpGolomb(out, gap, 0);
    writeExpGolomb(out, zigzag(length - last), 0);
    last = length;
    gap = 0;
  }
}

HuffmanCode HuffmanCode::readFrom(BitReader& in, size_t symbols) {
  HuffmanCode code;
  code.lengths_.assign(symbols, 0);
  const uint64_t used = readExpGolomb(in, kCountOrder);
  if (used > symbols) in.fail();
  if (used == 1) {
    const uint64_t only = readExpGolomb(in, kCountOrder);
    if (only >= symbols) in.fail();
    code.only_ = in.overrun() ? -1 : static_cast<int>(only);
  } else {
    size_t next = 0;
    int last = 4;
    uint32_t kraft = 0;
    for (uint64_t i = 0; i < used && !in.overrun(); ++i) {
      const uint64_t gap = readExpGolomb(in, 0);
      last += unzigzag(readExpGolomb(in, 0) & 63);
      if (gap >= symbols - next || last < 1 || last > static_cast<int>(kMaxHuffmanLength)) {
        in.fail();
        break;
      }
      next += gap;
      code.lengths_[next++] = static_cast<uint8_t>(last);
      kraft += 1U << (kMaxHuffmanLength - static_cast<unsigned>(last));
    }
    if (used > 0 && kraft != 1U << kMaxHuffmanLength) in.fail();
  }
  if (in.overrun()) return {};
  code.build();
  return code;
}

bool HuffmanCode::has(size_t symbol) const {
  return symbol < lengths_.size() && (lengths_[symbol] > 0 || static_cast<int>(symbol) == only_);
}

void HuffmanCode::build() {
  codes_.assign(lengths_.size(), 0);
  std::array<uint32_t, kMaxHuffmanLength + 2> count{};
  for (const uint8_t length : lengths_) ++count[length];
  count[0] = 0;
  order_.clear();
  uint32_t next = 0;
  uint32_t index = 0;
  for (unsigned length = 1; length <= kMaxHuffmanLength; ++length) {
    next = (next + count[length - 1]) << 1;
    firstCode_[length] = next;
    firstIndex_[length] = index;
    index += count[length];
  }
  firstIndex_[kMaxHuffmanLength + 1] = index;
  order_.resize(index);
  auto place = firstIndex_;
  auto code = firstCode_;
  for (size_t symbol = 0; symbol < lengths_.size(); ++symbol) {
    const unsigned length = lengths_[symbol];
    if (length == 0) continue;
    order_[place[length]++] = static_cast<uint16_t>(symbol);
    codes_[symbol] = static_cast<uint16_t>(code[length]++);
    if (length > kTableBits) continue;
    const size_t begin = static_cast<size_t>(codes_[symbol]) << (kTableBits - length);
    const size_t end = begin + (size_t{1} << (kTableBits - length));
    for (size_t i = begin; i < end; ++i)
      table_[i] = {static_cast<uint16_t>(symbol), static_cast<uint16_t>(length)};
  }
  if (only_ >= 0)
    for (auto& entry : table_) entry = {static_cast<uint16_t>(only_), 0};
}

HuffmanCode::Entry HuffmanCode::longEntry(uint32_t window) const {
  if (order_.empty()) return {};
  for (unsigned length = kTableBits + 1; length <= kMaxHuffmanLength; ++length) {
    const uint32_t code = window >> (kMaxHuffmanLength - length);
    const uint32_t index = firstIndex_[length] + code - firstCode_[length];
    if (code >= firstCode_[length] && index < firstIndex_[length + 1])
      return {order_[index], static_cast<uint16_t>(length)};
  }
  return {};
}

}  // namespace meshfront
