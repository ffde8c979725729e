// Chunks: the records of a mesh cut into constant pieces of about 512 records (2 KB) for storage,
// standard HTTP caches and static hosting.
//
// Band b holds the records of the nodes at significance level b. Within a band the records stand in
// preorder (NodeId's order), cut into runs. Chunks are numbered from band 0 on.
// A chunk stands alone: magic "MFC", version, band, record count, the entries (nodes whose parents
// lie outside; a tree bitstring), the records bit by bit, zero bits up to a byte, CRC-32C.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/codec/code_tables.h"
#include "shared/hierarchy/node_id.h"
#include "shared/result.h"

namespace meshfront {

inline constexpr uint32_t kRecordsPerChunk = 512;

// Where a record lies, and what parsing it told about the children.
struct RecordEntry {
  NodeId id;
  uint8_t level = 0;
  bool leftIsLeaf = false;
  bool rightIsLeaf = false;
  uint8_t leftLevel = 0;
  uint8_t rightLevel = 0;
  uint32_t bitLength = 0;
  uint64_t bitOffset = 0;  // from the first bit of the chunk's (or answer's) bytes
};

// `records`: bits of one band's run; `entries[i]` says where record i lies in `source`, in
// preorder.
[[nodiscard]] std::vector<uint8_t> encodeChunk(unsigned band, std::span<const RecordEntry> entries,
                                               std::span<const uint8_t> source);

struct Chunk {
  unsigned band = 0;
  std::vector<RecordEntry> entries;  // preorder; offsets into the chunk's own bytes
};
// Untrusted.
[[nodiscard]] Result<Chunk> decodeChunk(std::span<const uint8_t> bytes, const CodeTables& tables);

// The index of all chunks: the first node of each, by band.
struct ChunkIndex {
  std::vector<std::vector<NodeId>> firstNodes;  // [band][chunk within the band], ascending
  [[nodiscard]] uint32_t chunkCount() const;
  // The chunk that holds the node of that level, if any does.
  [[nodiscard]] std::optional<uint32_t> find(const NodeId& node, unsigned level) const;
};
[[nodiscard]] std::vector<uint8_t> encodeChunkIndex(const ChunkIndex& index);
[[nodiscard]] Result<ChunkIndex> decodeChunkIndex(std::span<const uint8_t> bytes);  // untrusted

}  // namespace meshfront
