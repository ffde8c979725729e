// The record store over a pack. Records are copied bit by bit from the mapped chunks; a chunk's
// records are indexed when the first of them is asked for, under a budget of bytes that several
// packs share, and forgotten chunk by chunk (clock).
//
// Locking: mutex_ guards the table and the chunks' pointers. Requests for indexed records hold it
// shared, once a request; a chunk is decoded without it and added under it. The used bits of the
// clock are atomic, because readers set them.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <span>
#include <vector>

#include "shared/codec/base_mesh.h"
#include "shared/codec/chunk.h"
#include "shared/store/index_statistics.h"
#include "shared/store/memory_budget.h"
#include "shared/store/pack.h"
#include "shared/store/record_store.h"
#include "shared/store/record_table.h"

namespace meshfront {

class PackStore final : public RecordStore, private MemoryBudget::Member {
 public:
  // Reads nothing but what opening the pack has read.
  // `statistics`: to count in with others; none: nobody wants to know.
  PackStore(std::shared_ptr<const Pack> pack, std::shared_ptr<MemoryBudget> budget,
            std::shared_ptr<IndexStatistics> statistics = std::make_shared<IndexStatistics>());
  ~PackStore() override;

  [[nodiscard]] const MeshMetadata& metadata() const { return pack_->metadata(); }
  [[nodiscard]] Result<HeldBytes> base(Waiting waiting) override;
  [[nodiscard]] Result<HeldBytes> chunkIndex(Waiting waiting) override;
  [[nodiscard]] Result<HeldBytes> chunk(uint32_t number, Waiting waiting) override;
  [[nodiscard]] Result<Answer> collect(std::span<const NodeId> wanted, const Expansion& expansion,
                                       const CollectLimits& limits, Waiting waiting) override;
  [[nodiscard]] Result<unsigned> maxLevel() override;

 private:
  class Collector;
  // What of base and chunk index is needed to find records; decoded at first need.
  struct Directory {
    std::vector<BaseMesh::Root> roots;
    CodeTables tables;
    ChunkIndex chunks;
  };
  struct ChunkState {
    std::span<const uint8_t> bytes;  // set at the first touch, for ever: it points into the map
    bool indexed = false;
    std::atomic<bool> used{false};
    std::atomic<bool> sound{false};  // its checksum was right when it was served whole
  };

  [[nodiscard]] Result<const Directory*> directory();
  [[nodiscard]] Result<Directory> readDirectory() const;
  // Finds the place of any node, indexing chunks on the way down. No lock held.
  [[nodiscard]] Result<RecordPlace> locate(const NodeId& node, const Directory& directory);
  [[nodiscard]] Result<RecordPlace> indexChunkOf(const NodeId& node, unsigned level,
                                                 const Directory& directory);

  [[nodiscard]] size_t heldBytes() const override { return indexBytes_.load(); }
  void release(size_t bytes) override;

  const std::shared_ptr<const Pack> pack_;
  const std::shared_ptr<MemoryBudget> budget_;
  const std::shared_ptr<IndexStatistics> statistics_;
  std::once_flag directoryRead_;
  Result<Directory> directory_ = Directory{};

  std::shared_mutex mutex_;
  RecordTable table_;
  std::vector<ChunkState> chunks_;
  size_t hand_ = 0;
  std::atomic<size_t> indexBytes_{0};
};

}  // namespace meshfront
