#include "shared/receiver/record_segment.h"

#include <algorithm>
#include <array>

#include "shared/bits/bit_reader.h"
#include "shared/bits/crc32c.h"

namespace meshfront {
namespace {

constexpr std::array<uint8_t, 8> kSegmentMagic{'M', 'F', 'R', 'S', 1, 0, 0, 0};
constexpr std::array<uint8_t, 4> kBlockMagic{'M', 'F', 'R', 'B'};
// In a segment; what follows the last one is left out. Bytes made so that each has a checksum of
// its own to be found wrong would otherwise take hours.
constexpr unsigned kMostDamages = 64;

void appendWord(std::vector<uint8_t>& out, uint32_t word) {
  for (unsigned i = 0; i < 4; ++i) out.push_back(static_cast<uint8_t>(word >> (8 * i)));
}

uint32_t wordAt(std::span<const uint8_t> bytes, size_t at) {
  uint32_t word = 0;
  for (unsigned i = 0; i < 4; ++i) word |= uint32_t{bytes[at + i]} << (8 * i);
  return word;
}

void appendLeb(std::vector<uint8_t>& out, uint32_t value) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<uint8_t>(value | 0x80));
  out.push_back(static_cast<uint8_t>(value));
}

std::optional<uint32_t> takeLeb(std::span<const uint8_t> bytes, size_t& at) {
  uint64_t value = 0;
  for (unsigned shift = 0; shift < 35; shift += 7) {
    if (at >= bytes.size()) return std::nullopt;
    const uint8_t octet = bytes[at++];
    value |= uint64_t{octet & 0x7FU} << shift;
    if (octet < 0x80)
      return value <= UINT32_MAX ? std::optional(static_cast<uint32_t>(value)) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

std::vector<uint8_t> segmentHeader(uint32_t key) {
  std::vector<uint8_t> header(kSegmentMagic.begin(), kSegmentMagic.end());
  appendWord(header, key);
  appendChecksum(header);
  return header;
}

bool isSegmentHeader(std::span<const uint8_t> bytes, uint32_t key) {
  const std::vector<uint8_t> expected = segmentHeader(key);
  return bytes.size() >= expected.size() &&
         std::equal(expected.begin(), expected.end(), bytes.begin());
}

std::vector<uint8_t> encodeBlock(std::span<const uint8_t> payload) {
  std::vector<uint8_t> block(kBlockMagic.begin(), kBlockMagic.end());
  appendWord(block, static_cast<uint32_t>(payload.size()));
  const uint32_t lengthSum = crc32c(std::span(block).subspan(kBlockMagic.size()));
  appendWord(block, crc32c(payload, lengthSum));
  block.insert(block.end(), payload.begin(), payload.end());
  return block;
}

std::optional<std::span<const uint8_t>> blockPayload(std::span<const uint8_t> bytes) {
  if (bytes.size() < kBlockHeaderBytes ||
      !std::equal(kBlockMagic.begin(), kBlockMagic.end(), bytes.begin()))
    return std::nullopt;
  const uint32_t length = wordAt(bytes, 4);
  if (length > kMostBlockPayload || length > bytes.size() - kBlockHeaderBytes) return std::nullopt;
  const std::span<const uint8_t> payload = bytes.subspan(kBlockHeaderBytes, length);
  if (crc32c(payload, crc32c(bytes.subspan(4, 4))) != wordAt(bytes, 8)) return std::nullopt;
  return payload;
}

bool appendEntry(std::vector<uint8_t>& payload, const NodeId& id, std::span<const uint8_t> bytes,
                 uint64_t bitOffset, uint32_t bitLength) {
  if (bitLength > kMostRecordBits || bitOffset + bitLength > bytes.size() * 8) return false;
  appendLeb(payload, id.tree);
  payload.push_back(id.depth);
  for (unsigned i = 0; i < (id.depth + 7U) / 8; ++i)
    payload.push_back(static_cast<uint8_t>(id.path >> (56 - 8 * i)));
  appendLeb(payload, bitLength);
  BitReader in(bytes, bitOffset, bitOffset + bitLength);
  for (uint32_t left = bitLength; left > 0;) {
    const uint32_t step = std::min(left, 8U);
    payload.push_back(static_cast<uint8_t>(in.read(step) << (8 - step)));
    left -= step;
  }
  return true;
}

std::optional<SegmentEntry> parseEntry(std::span<const uint8_t> payload, size_t at) {
  SegmentEntry entry;
  const std::optional<uint32_t> tree = takeLeb(payload, at);
  if (!tree || at >= payload.size()) return std::nullopt;
  entry.id.tree = *tree;
  entry.id.depth = payload[at++];
  if (entry.id.depth > kMaxDepth) return std::nullopt;
  const size_t pathBytes = (entry.id.depth + 7U) / 8;
  if (pathBytes > payload.size() - at) return std::nullopt;
  for (unsigned i = 0; i < pathBytes; ++i) entry.id.path |= uint64_t{payload[at++]} << (56 - 8 * i);
  if (entry.id.ancestor(entry.id.depth).path != entry.id.path) return std::nullopt;
  const std::optional<uint32_t> bits = takeLeb(payload, at);
  if (!bits || *bits > kMostRecordBits || (*bits + 7) / 8 > payload.size() - at)
    return std::nullopt;
  entry.bitOffset = uint64_t{at} * 8;
  entry.bitLength = *bits;
  entry.end = at + (*bits + 7) / 8;
  return entry;
}

SegmentScan scanSegment(std::span<const uint8_t> bytes, uint32_t key,
                        const SegmentVisitor& onEntry) {
  SegmentScan scan;
  if (!isSegmentHeader(bytes, key)) {
    scan.damagedBytes = bytes.size();
    return scan;
  }
  unsigned damages = 0;
  for (size_t at = kSegmentHeaderBytes; at < bytes.size();) {
    const auto payload = blockPayload(bytes.subspan(at));
    if (!payload && ++damages > kMostDamages) {
      scan.damagedBytes += bytes.size() - at;
      break;
    }
    if (!payload) {
      const auto next = std::search(bytes.begin() + static_cast<ptrdiff_t>(at) + 1, bytes.end(),
                                    kBlockMagic.begin(), kBlockMagic.end());
      const auto found = static_cast<size_t>(next - bytes.begin());
      scan.damagedBytes += found - at;
      at = found;
      continue;
    }
    ++scan.blocks;
    for (size_t inside = 0; inside < payload->size();) {
      const std::optional<SegmentEntry> entry = parseEntry(*payload, inside);
      if (!entry) break;
      onEntry(*entry, at, inside, *payload);
      inside = entry->end;
    }
    at += kBlockHeaderBytes + payload->size();
  }
  return scan;
}

}  // namespace meshfront
