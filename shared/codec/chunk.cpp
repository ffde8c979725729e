#include "shared/codec/chunk.h"

#include <algorithm>

#include "shared/bits/crc32c.h"
#include "shared/bits/integer_codes.h"
#include "shared/codec/record.h"
#include "shared/codec/subtree_reader.h"
#include "shared/hierarchy/tree_bitstring.h"

namespace meshfront {
namespace {

constexpr uint64_t kChunkMagic = 0x4D464302;  // "MFC", version 2
constexpr uint64_t kIndexMagic = 0x4D464901;  // "MFI", version 1
constexpr unsigned kMagicBits = 32;
constexpr unsigned kBandBits = 5;
constexpr unsigned kCountOrder = 9;
constexpr unsigned kDepthBits = 6;
constexpr unsigned kTreeOrder = 4;

void writePath(BitWriter& out, const NodeId& node) {
  const unsigned high = std::min<unsigned>(node.depth, 32);
  const unsigned low = node.depth - high;
  out.write(node.depth, kDepthBits);
  if (high > 0) out.write(node.path >> (64 - high), high);
  if (low > 0) out.write((node.path & 0xFFFFFFFFU) >> (32 - low), low);
}

NodeId readPath(BitReader& in, uint32_t tree) {
  NodeId node{tree, static_cast<uint8_t>(in.read(kDepthBits)), 0};
  const unsigned high = std::min<unsigned>(node.depth, 32);
  const unsigned low = node.depth - high;
  if (high > 0) node.path = in.read(high) << (64 - high);
  if (low > 0) node.path |= in.read(low) << (32 - low);
  return node;
}

}  // namespace

std::vector<uint8_t> encodeChunk(unsigned band, std::span<const RecordEntry> entries,
                                 std::span<const uint8_t> source) {
  std::vector<NodeId> outside;
  for (const RecordEntry& entry : entries)
    if (outside.empty() || !outside.back().isAncestorOf(entry.id)) outside.push_back(entry.id);
  BitWriter out;
  out.write(kChunkMagic, kMagicBits);
  out.write(band, kBandBits);
  writeExpGolomb(out, entries.size(), kCountOrder);
  static_cast<void>(writeTreeBitstring(out, outside));  // an antichain in preorder by construction
  for (const RecordEntry& entry : entries) out.append(source, entry.bitOffset, entry.bitLength);
  std::vector<uint8_t> bytes = out.take();
  appendChecksum(bytes);
  return bytes;
}

Result<Chunk> decodeChunk(std::span<const uint8_t> bytes, const CodeTables& tables) {
  const auto content = checkedContent(bytes, "chunk");
  if (!content) return tl::unexpected(content.error());
  BitReader in(*content);
  if (in.read(kMagicBits) != kChunkMagic)
    return fail("chunk: not a chunk of this version of the format");
  Chunk chunk;
  chunk.band = static_cast<unsigned>(in.read(kBandBits));
  if (chunk.band > tables.maxLevel) return fail("chunk: a band beyond the mesh's levels");
  const uint64_t count = readExpGolomb(in, kCountOrder);
  // The least that a record takes depends on the tables; an entry list never needs more than this.
  if (count == 0 || count > in.left() + kRecordsPerChunk) return fail("chunk: wrong record count");
  const auto outside = readTreeBitstring(in, count);
  if (!outside) return tl::unexpected(outside.error());

  const unsigned band = chunk.band;
  chunk.entries.reserve(std::min<uint64_t>(count, 2 * kRecordsPerChunk));  // as far as it is likely
  const auto sameBand = [band](unsigned, unsigned level) { return level == band; };
  std::vector<PendingRecord> pending;
  for (const NodeId& node : *outside)
    if (!readSubtree(in, tables, node, band, sameBand, count, pending, chunk.entries))
      return fail("chunk: damaged records");
  if (chunk.entries.size() != count) return fail("chunk: wrong record count");
  if (in.left() >= 8 || in.read(static_cast<unsigned>(in.left())) != 0)
    return fail("chunk: bits behind the last record");
  return chunk;
}

uint32_t ChunkIndex::chunkCount() const {
  size_t count = 0;
  for (const auto& band : firstNodes) count += band.size();
  return static_cast<uint32_t>(count);
}

std::optional<uint32_t> ChunkIndex::find(const NodeId& node, unsigned level) const {
  if (level >= firstNodes.size()) return std::nullopt;
  size_t number = 0;
  for (unsigned band = 0; band < level; ++band) number += firstNodes[band].size();
  const auto& starts = firstNodes[level];
  const auto above = std::upper_bound(starts.begin(), starts.end(), node);
  if (above == starts.begin()) return std::nullopt;
  return static_cast<uint32_t>(number + static_cast<size_t>(above - starts.begin()) - 1);
}

std::vector<uint8_t> encodeChunkIndex(const ChunkIndex& index) {
  BitWriter out;
  out.write(kIndexMagic, kMagicBits);
  out.write(index.firstNodes.size(), kBandBits + 1);
  for (const auto& band : index.firstNodes) {
    writeExpGolomb(out, band.size(), 4);
    uint32_t last = 0;
    for (const NodeId& node : band) {
      writeExpGolomb(out, node.tree - last, kTreeOrder);
      writePath(out, node);
      last = node.tree;
    }
  }
  std::vector<uint8_t> bytes = out.take();
  appendChecksum(bytes);
  return bytes;
}

Result<ChunkIndex> decodeChunkIndex(std::span<const uint8_t> bytes) {
  const auto content = checkedContent(bytes, "chunk index");
  if (!content) return tl::unexpected(content.error());
  BitReader in(*content);
  if (in.read(kMagicBits) != kIndexMagic)
    return fail("chunk index: not an index of this version of the format");
  ChunkIndex index;
  const uint64_t bands = in.read(kBandBits + 1);
  if (bands > kMaxLevel + 1) return fail("chunk index: more bands than levels");
  index.firstNodes.resize(bands);
  for (auto& band : index.firstNodes) {
    const uint64_t count = readExpGolomb(in, 4);
    if (count > in.left()) return fail("chunk index: wrong chunk count");
    uint64_t tree = 0;
    for (uint64_t i = 0; i < count; ++i) {
      tree += readExpGolomb(in, kTreeOrder);
      if (tree > UINT32_MAX) return fail("chunk index: a tree number beyond 32 bits");
      const NodeId node = readPath(in, static_cast<uint32_t>(tree));
      if (in.overrun()) return fail("chunk index: cut short");
      if (!band.empty() && node <= band.back()) return fail("chunk index: not in order");
      band.push_back(node);
    }
  }
  if (in.overrun() || in.left() >= 8 || in.read(static_cast<unsigned>(in.left())) != 0)
    return fail("chunk index: cut short, or bits behind the last chunk");
  return index;
}

}  // namespace meshfront
