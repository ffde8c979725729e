// The bytes of a segment: an append-only file of the records of one revision.
//
//   segment  header, blocks
//   header   magic "MFRS", version, three zeros, key u32 (of the revision), CRC-32C of these
//   block    magic "MFRB", length u32 of the payload, CRC-32C of length and payload, payload
//   payload  entries: tree (LEB128), depth u8, the path's (depth + 7) / 8 first octets, bits in the
//            record (LEB128), the record's bits, zero bits up to an octet
//
// Numbers are little-endian. Untrusted: a torn tail or a damaged block is left out, and what
// follows is found by the next magic.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "shared/hierarchy/node_id.h"

namespace meshfront {

inline constexpr size_t kSegmentHeaderBytes = 16;
inline constexpr size_t kBlockHeaderBytes = 12;
inline constexpr size_t kMostBlockPayload = size_t{64} << 10;  // entries' places fit 16 bits
inline constexpr uint32_t kMostRecordBits = 1 << 14;           // 2 KiB

[[nodiscard]] std::vector<uint8_t> segmentHeader(uint32_t key);
[[nodiscard]] bool isSegmentHeader(std::span<const uint8_t> bytes, uint32_t key);

// `payload`: at most kMostBlockPayload octets.
[[nodiscard]] std::vector<uint8_t> encodeBlock(std::span<const uint8_t> payload);
// The payload of the block at the beginning of `bytes`, if there is a sound one.
[[nodiscard]] std::optional<std::span<const uint8_t>> blockPayload(std::span<const uint8_t> bytes);

struct SegmentEntry {
  NodeId id{};
  uint64_t bitOffset = 0;  // from the payload's beginning
  uint32_t bitLength = 0;
  size_t end = 0;  // octets: where the next entry begins
};
// False: the record is too long to be one.
bool appendEntry(std::vector<uint8_t>& payload, const NodeId& id, std::span<const uint8_t> bytes,
                 uint64_t bitOffset, uint32_t bitLength);
[[nodiscard]] std::optional<SegmentEntry> parseEntry(std::span<const uint8_t> payload, size_t at);

struct SegmentScan {
  uint64_t blocks = 0;
  uint64_t damagedBytes = 0;  // that belong to no sound block
};
// Calls `onEntry` for each entry of each sound block, with the block's offset in `bytes` and the
// entry's in its payload.
using SegmentVisitor = std::function<void(const SegmentEntry& entry, size_t block, size_t at,  //
                                          std::span<const uint8_t> payload)>;
SegmentScan scanSegment(std::span<const uint8_t> bytes, uint32_t key,
                        const SegmentVisitor& onEntry);

}  // namespace meshfront
