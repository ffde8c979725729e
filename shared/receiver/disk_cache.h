// A receiver's disk cache: what it was sent of a mesh, for the next time. Metadata by mesh; base
// mesh, chunk index and records by revision.
//
//   auto cache = DiskCache::open("/home/me/.cache/meshfront", 1 << 30, url);
//   cache->useRevision(revision);
//   if (auto record = cache->find(id)) mesh.split(node, record->bytes, ...);
//   cache->keep(id, bytes, bitOffset, bitLength);
//
// Never an error: a cache that cannot be read is empty, one that cannot be written is as it was,
// and problem() says so. What it gives is as untrusted as what the network gives, but for a
// checksum over each block of some hundred records: damage is left out, not applied. Any number of
// caches, in any number of processes, may use a folder at once (cache_folder.h). Each appends to a
// segment of its own, and knows of the others' what was there when it began. Records are written
// when some kilobytes have come together, after kFlushInterval, or at the end; what is not yet
// written is lost with the process. Belongs to the receiver's thread; reads and writes files there.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/receiver/cache_folder.h"
#include "shared/receiver/locked_file.h"
#include "shared/receiver/mesh_url.h"
#include "shared/receiver/record_index.h"

namespace meshfront {

struct DiskRecord {
  std::span<const uint8_t> bytes;  // valid until the next call
  uint64_t bitOffset = 0;
  uint32_t bitLength = 0;
};

struct DiskCacheStatistics {
  uint64_t records = 0;       // known, of this revision
  uint64_t found = 0;         // times that find() gave one
  uint64_t written = 0;       // records that this cache has written
  uint64_t bytesWritten = 0;  // for them
  uint64_t damagedBytes = 0;  // left out
};

class DiskCache {
 public:
  static constexpr std::chrono::seconds kFlushInterval{2};

  // `budget`: octets, over all meshes in the folder. Makes the folder when there is something to
  // write.
  [[nodiscard]] static std::unique_ptr<DiskCache> open(const std::filesystem::path& folder,
                                                       uint64_t budget, const MeshUrl& url);
  ~DiskCache();
  DiskCache(const DiskCache&) = delete;
  DiskCache& operator=(const DiskCache&) = delete;

  // As it was served last.
  [[nodiscard]] std::optional<std::vector<uint8_t>> metadata() const;
  // `revision`: that it names. The mesh's other revisions are of no more use.
  void keepMetadata(std::span<const uint8_t> document, const std::string& revision);

  // What follows is of that one; isRevision(revision). Finds what segments hold.
  void useRevision(const std::string& revision);
  [[nodiscard]] const std::string& revision() const { return revision_; }
  [[nodiscard]] std::optional<std::vector<uint8_t>> base() const;
  void keepBase(std::span<const uint8_t> bytes);
  [[nodiscard]] std::optional<std::vector<uint8_t>> chunkIndex() const;
  void keepChunkIndex(std::span<const uint8_t> bytes);

  // Very likely; find() may yet see that it is damaged.
  [[nodiscard]] bool has(const NodeId& id) const { return index_.find(id).has_value(); }
  [[nodiscard]] std::optional<DiskRecord> find(const NodeId& id);
  // Nothing new where has().
  void keep(const NodeId& id, std::span<const uint8_t> bytes, uint64_t bitOffset,
            uint32_t bitLength);
  void forget(const NodeId& id) { index_.erase(id); }  // it turned out wrong

  // Writes what waits when it is time.
  void tick(std::chrono::steady_clock::time_point now);
  void flush();

  [[nodiscard]] DiskCacheStatistics statistics() const;
  // Why nothing more is written; empty: all is well.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  struct Segment {
    LockedFile file;
    bool touched = false;
  };
  struct Block {
    uint16_t segment = 0;
    uint32_t offset = 0;
    std::vector<uint8_t> payload;
  };

  DiskCache(const std::filesystem::path& folder, uint64_t budget, const MeshUrl& url);
  void closeRevision();
  void readSegments();
  void readSegment(const std::filesystem::path& path);
  void mergeSmall(const std::vector<std::filesystem::path>& paths);
  [[nodiscard]] bool mayWrite() const { return problem_.empty() && inUse_.isOpen(); }
  [[nodiscard]] bool grant(uint64_t bytes);
  [[nodiscard]] bool beginSegment();
  void keepDocument(const std::filesystem::path& path, std::span<const uint8_t> bytes);
  [[nodiscard]] std::optional<std::span<const uint8_t>> payloadAt(CachedPlace place);
  void giveUpWriting(const std::string& why);

  const CacheFolder folder_;
  const uint64_t mostSegmentBytes_;
  std::string revision_;
  uint32_t key_ = 0;  // of the revision, in its segments
  LockedFile inUse_;  // while a revision is used
  RecordIndex index_;
  std::vector<Segment> segments_;
  std::vector<Block> blocks_;  // read last: each has one place where it may be

  std::optional<uint16_t> own_;   // the segment that is being written
  uint32_t ownBytes_ = 0;         // its length
  std::vector<uint8_t> pending_;  // the payload of its next block
  std::vector<NodeId> pendingIds_;
  std::optional<std::chrono::steady_clock::time_point> pendingSince_;
  uint64_t granted_ = 0;  // octets that may be written before room is made again
  std::string problem_;
  DiskCacheStatistics statistics_;
};

}  // namespace meshfront
