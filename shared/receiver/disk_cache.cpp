#include "shared/receiver/disk_cache.h"

#include <algorithm>
#include <utility>

#include "shared/receiver/record_segment.h"
#include "shared/store/entity_tag.h"
#include "shared/store/mesh_metadata.h"

namespace meshfront {
namespace {

namespace fs = std::filesystem;
using Lock = LockedFile::Lock;
using Wait = LockedFile::Wait;

constexpr size_t kBlockPayload = size_t{4} << 10;
constexpr size_t kLongestEntry = size_t{3} << 10;
constexpr size_t kBlocksInMemory = 2'048;  // 8 MiB
constexpr uint64_t kLeastSegmentBytes = uint64_t{64} << 10;
constexpr uint64_t kMostSegmentBytes = uint64_t{16} << 20;
constexpr uint64_t kMostGrant = uint64_t{1} << 20;
constexpr size_t kMostSegments = 1'024;  // open at once
constexpr size_t kManySegments = 24;     // beyond, small ones are merged
// Of the budget: a new run drops old segments, even of its own revision, for so much.
constexpr double kRoomForNews = 0.15;

}  // namespace

std::unique_ptr<DiskCache> DiskCache::open(const fs::path& folder, uint64_t budget,
                                           const MeshUrl& url) {
  return std::unique_ptr<DiskCache>(new DiskCache(folder, budget, url));
}

DiskCache::DiskCache(const fs::path& folder, uint64_t budget, const MeshUrl& url)
    : folder_(folder, budget, url),
      mostSegmentBytes_(std::clamp(budget / 16, kLeastSegmentBytes, kMostSegmentBytes)) {}

DiskCache::~DiskCache() {
  closeRevision();
}

// --- documents -----------------------------------------------------------------------------------

std::optional<std::vector<uint8_t>> DiskCache::metadata() const {
  return CacheFolder::readDocument(folder_.meshFolder() / "metadata");
}

void DiskCache::keepMetadata(std::span<const uint8_t> document, const std::string& revision) {
  const auto before = metadata();
  if (before && std::equal(before->begin(), before->end(), document.begin(), document.end()))
    return;
  keepDocument(folder_.meshFolder() / "metadata", document);
  folder_.ageOthers(revision);
}

std::optional<std::vector<uint8_t>> DiskCache::base() const {
  return CacheFolder::readDocument(folder_.revisionFolder(revision_) / "base");
}

void DiskCache::keepBase(std::span<const uint8_t> bytes) {
  keepDocument(folder_.revisionFolder(revision_) / "base", bytes);
}

std::optional<std::vector<uint8_t>> DiskCache::chunkIndex() const {
  return CacheFolder::readDocument(folder_.revisionFolder(revision_) / "chunks");
}

void DiskCache::keepChunkIndex(std::span<const uint8_t> bytes) {
  keepDocument(folder_.revisionFolder(revision_) / "chunks", bytes);
}

void DiskCache::keepDocument(const fs::path& path, std::span<const uint8_t> bytes) {
  if (!problem_.empty()) return;
  const Result<void> written = folder_.writeDocument(path, bytes);
  if (!written) giveUpWriting(written.error().message);
}

// --- a revision ----------------------------------------------------------------------------------

void DiskCache::useRevision(const std::string& revision) {
  if (revision == revision_) return;
  closeRevision();
  if (!isRevision(revision)) return;
  revision_ = revision;
  key_ = resourceKey(revision, "records");
  (void)folder_.makeRoom(
      static_cast<uint64_t>(kRoomForNews * static_cast<double>(folder_.budget())));
  Result<LockedFile> inUse = folder_.enter(revision);
  if (inUse) {
    inUse_ = std::move(*inUse);
  } else {
    giveUpWriting(inUse.error().message);  // reading may still work
  }
  readSegments();
}

void DiskCache::closeRevision() {
  flush();
  if (own_) segments_[*own_].file.synchronise();
  own_.reset();
  segments_.clear();
  blocks_.clear();
  index_ = {};
  revision_.clear();
  inUse_ = {};
}

void DiskCache::readSegments() {
  std::vector<fs::path> paths;
  std::error_code error;
  for (fs::directory_iterator it(folder_.revisionFolder(revision_), error), end;
       !error && it != end; it.increment(error))
    if (it->path().filename().string().starts_with("segment-")) paths.push_back(it->path());
  std::sort(paths.begin(), paths.end());
  for (const fs::path& path : paths) readSegment(path);
  if (paths.size() > kManySegments) mergeSmall(paths);
}

void DiskCache::readSegment(const fs::path& path) {
  if (segments_.size() >= kMostSegments) return;
  std::optional<LockedFile> file = LockedFile::open(path, Lock::shared, Wait::no);
  // Longer ones are none of ours.
  if (!file || file->size() > 2 * kMostSegmentBytes) return;
  const std::vector<uint8_t> bytes = file->read(0, static_cast<size_t>(file->size()));
  const auto number = static_cast<uint16_t>(segments_.size());
  const SegmentScan scan = scanSegment(
      bytes, key_,
      [&](const SegmentEntry& entry, size_t block, size_t at, std::span<const uint8_t>) {
        index_.set(entry.id, {number, static_cast<uint16_t>(at), static_cast<uint32_t>(block)});
      });
  statistics_.damagedBytes += scan.damagedBytes;
  segments_.push_back({std::move(*file), false});
}

// Each run leaves one; many small ones cost files held open. Their records go into this run's own.
void DiskCache::mergeSmall(const std::vector<fs::path>& paths) {
  std::vector<fs::path> merged;
  segments_.clear();  // our locks, too
  index_ = {};
  statistics_.damagedBytes = 0;
  for (const fs::path& path : paths) {
    const auto file = LockedFile::open(path, Lock::exclusive, Wait::no);
    const uint64_t size = file ? file->size() : 0;
    if (!file || size > mostSegmentBytes_ / 4 || !mayWrite()) continue;
    const std::vector<uint8_t> bytes = file->read(0, static_cast<size_t>(size));
    scanSegment(
        bytes, key_,
        [this](const SegmentEntry& entry, size_t, size_t, std::span<const uint8_t> payload) {
          keep(entry.id, payload, entry.bitOffset, entry.bitLength);
        });
    merged.push_back(path);
  }
  flush();
  std::error_code error;
  if (own_) segments_[*own_].file.synchronise();
  for (const fs::path& path : merged)
    if (problem_.empty()) fs::remove(path, error);
  for (const fs::path& path : paths)
    if (!problem_.empty() || std::find(merged.begin(), merged.end(), path) == merged.end())
      readSegment(path);
}

// --- reading -------------------------------------------------------------------------------------

std::optional<DiskRecord> DiskCache::find(const NodeId& id) {
  const std::optional<CachedPlace> place = index_.find(id);
  if (!place) return std::nullopt;
  const auto payload = payloadAt(*place);
  const auto entry = payload ? parseEntry(*payload, place->inBlock) : std::nullopt;
  if (!entry || entry->id != id) {
    index_.erase(id);
    return std::nullopt;
  }
  ++statistics_.found;
  return DiskRecord{*payload, entry->bitOffset, entry->bitLength};
}

std::optional<std::span<const uint8_t>> DiskCache::payloadAt(CachedPlace place) {
  if (own_ == place.segment && place.block == ownBytes_) return pending_;
  if (place.segment >= segments_.size()) return std::nullopt;
  if (blocks_.empty()) blocks_.resize(kBlocksInMemory);
  const size_t mixed = (size_t{place.segment} << 32 | place.block) * 0x9E3779B97F4A7C15ULL;
  Block& block = blocks_[(mixed >> 32) % kBlocksInMemory];
  if (block.offset == place.block && block.segment == place.segment) return block.payload;
  Segment& segment = segments_[place.segment];
  if (!std::exchange(segment.touched, true)) segment.file.touch();
  const std::vector<uint8_t> bytes =
      segment.file.read(place.block, kBlockHeaderBytes + kBlockPayload + kLongestEntry);
  const auto payload = blockPayload(bytes);
  if (!payload) return std::nullopt;
  block = {place.segment, place.block, {payload->begin(), payload->end()}};
  return block.payload;
}

// --- writing -------------------------------------------------------------------------------------

void DiskCache::keep(const NodeId& id, std::span<const uint8_t> bytes, uint64_t bitOffset,
                     uint32_t bitLength) {
  if (!mayWrite() || has(id)) return;
  if (!own_ && !beginSegment()) return;
  const size_t at = pending_.size();
  if (!appendEntry(pending_, id, bytes, bitOffset, bitLength)) return;
  index_.set(id, {*own_, static_cast<uint16_t>(at), ownBytes_});
  pendingIds_.push_back(id);
  if (pending_.size() >= kBlockPayload) flush();
}

bool DiskCache::beginSegment() {
  if (segments_.size() >= kMostSegments || !grant(kSegmentHeaderBytes + kBlockPayload)) {
    giveUpWriting("the disk cache is full of what is in use");
    return false;
  }
  const fs::path path = folder_.revisionFolder(revision_) / ("segment-" + chanceName());
  Result<LockedFile> file = LockedFile::make(path, Lock::shared, Wait::no);
  const std::vector<uint8_t> header = segmentHeader(key_);
  const Result<void> written = file ? file->append(header) : tl::unexpected(file.error());
  if (!written) {
    giveUpWriting(written.error().message);
    return false;
  }
  own_ = static_cast<uint16_t>(segments_.size());
  ownBytes_ = static_cast<uint32_t>(header.size());
  segments_.push_back({std::move(*file), true});
  return true;
}

bool DiskCache::grant(uint64_t bytes) {
  if (bytes > granted_) {
    const uint64_t wanted = std::max(bytes, std::min(kMostGrant, folder_.budget() / 16));
    granted_ = folder_.makeRoom(wanted) ? wanted : folder_.makeRoom(bytes) ? bytes : 0;
  }
  if (bytes > granted_) return false;
  granted_ -= bytes;
  return true;
}

void DiskCache::tick(std::chrono::steady_clock::time_point now) {
  if (pending_.empty()) {
    pendingSince_.reset();
  } else if (!pendingSince_) {
    pendingSince_ = now;
  } else if (now - *pendingSince_ >= kFlushInterval) {
    flush();
  }
}

void DiskCache::flush() {
  pendingSince_.reset();
  if (pending_.empty() || !own_) return;
  const std::vector<uint8_t> block = encodeBlock(pending_);
  LockedFile& file = segments_[*own_].file;
  if (!grant(block.size())) {
    giveUpWriting("the disk cache is full of what is in use");
    return;
  }
  if (const Result<void> written = file.append(block); !written) {
    file.cut(ownBytes_);
    giveUpWriting(written.error().message);
    return;
  }
  statistics_.written += pendingIds_.size();
  statistics_.bytesWritten += block.size();
  ownBytes_ += static_cast<uint32_t>(block.size());
  pending_.clear();
  pendingIds_.clear();
  if (ownBytes_ < mostSegmentBytes_) return;
  file.synchronise();
  own_.reset();
}

// What waits is forgotten: the mesh has it.
void DiskCache::giveUpWriting(const std::string& why) {
  problem_ = "the disk cache is not written any more: " + why;
  for (const NodeId& id : pendingIds_) index_.erase(id);
  pending_.clear();
  pendingIds_.clear();
  own_.reset();
}

DiskCacheStatistics DiskCache::statistics() const {
  DiskCacheStatistics statistics = statistics_;
  statistics.records = index_.count();
  return statistics;
}

}  // namespace meshfront
