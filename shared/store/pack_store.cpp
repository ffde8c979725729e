#include "shared/store/pack_store.h"

#include <algorithm>

#include "shared/bits/bit_writer.h"
#include "shared/bits/crc32c.h"
#include "shared/store/request_walk.h"

namespace meshfront {
namespace {

tl::unexpected<Error> noSuchNode() {
  return fail(ErrorCode::notFound, "no such node, or a leaf, which has no record");
}

}  // namespace

// Writes the records of one request. Holds the store's lock shared, but for the time in which a
// chunk has to be indexed.
class PackStore::Collector {
 public:
  Collector(PackStore& store, const Directory& directory, const CollectLimits& limits)
      : store_(store), directory_(directory), limits_(limits), lock_(store.mutex_) {}

  // The table's and the chunks' cache misses overlap within a block of nodes.
  Result<void> exactly(std::span<const NodeId> wanted) {
    constexpr size_t kBlock = 16;
    constexpr size_t kUsualBytes = 4;  // a record's
    out_.reserve(wanted.size() * kUsualBytes);
    std::array<RecordPlace, kBlock> places;
    for (size_t begin = 0; begin < wanted.size(); begin += kBlock) {
      const auto block = wanted.subspan(begin, std::min(kBlock, wanted.size() - begin));
      for (const NodeId& node : block) store_.table_.prefetch(node);
      for (size_t i = 0; i < block.size(); ++i) {
        if (const RecordPlace* known = store_.table_.find(block[i])) {
          places[i] = *known;
        } else {
          const auto found = placeOf(block[i]);
          if (!found) return tl::unexpected(found.error());
          places[i] = *found;
        }
        __builtin_prefetch(store_.chunks_[places[i].chunk].bytes.data() + places[i].bitOffset / 8);
      }
      for (size_t i = 0; i < block.size(); ++i)
        if (auto written = write(places[i]); !written) return written;
    }
    return {};
  }

  Result<void> expanded(std::span<const NodeId> wanted, const Expansion& expansion) {
    Result<void> status;
    walkRequest(
        wanted, expansion,
        [&](const NodeId& node, const Expansion&) -> std::optional<ChildFacts> {
          const auto place = placeOf(node);
          status = place ? write(*place) : tl::unexpected(place.error());
          if (!status) return std::nullopt;
          return place->children();
        },
        [&] { return !status; });
    return status;
  }

  [[nodiscard]] Answer finish() {
    store_.statistics_->hits.fetch_add(records_ - missed_, std::memory_order_relaxed);
    if (missed_ > 0) store_.statistics_->misses.fetch_add(missed_, std::memory_order_relaxed);
    Answer answer{out_.take(), records_};
    appendChecksum(answer.bytes);
    return answer;
  }

 private:
  Result<RecordPlace> placeOf(const NodeId& node) {
    if (const RecordPlace* place = store_.table_.find(node)) return *place;
    ++missed_;
    lock_.unlock();
    auto place = store_.locate(node, directory_);
    lock_.lock();
    return place;
  }

  Result<void> write(const RecordPlace& place) {
    ChunkState& chunk = store_.chunks_[place.chunk];
    if (!chunk.used.load(std::memory_order_relaxed))
      chunk.used.store(true, std::memory_order_relaxed);
    out_.append(chunk.bytes, place.bitOffset, place.bitLength());
    if (++records_ > limits_.maxRecords || out_.bitCount() / 8 > limits_.maxBytes)
      return fail(ErrorCode::tooLarge, "the answer would be too large; ask for fewer nodes");
    return {};
  }

  PackStore& store_;
  const Directory& directory_;
  const CollectLimits& limits_;
  std::shared_lock<std::shared_mutex> lock_;
  BitWriter out_;
  uint64_t records_ = 0;
  uint64_t missed_ = 0;
};

PackStore::PackStore(std::shared_ptr<const Pack> pack, std::shared_ptr<MemoryBudget> budget,
                     std::shared_ptr<IndexStatistics> statistics)
    : pack_(std::move(pack)),
      budget_(std::move(budget)),
      statistics_(std::move(statistics)),
      chunks_(pack_->metadata().chunkCount) {
  budget_->join(this);
}

PackStore::~PackStore() {
  budget_->leave(this);
}

// Caches would keep damaged bytes for as long as right ones.
Result<HeldBytes> PackStore::base(Waiting) {
  if (const auto sound = directory(); !sound) return tl::unexpected(sound.error());
  return HeldBytes(pack_->base(), pack_);
}
Result<HeldBytes> PackStore::chunkIndex(Waiting) {
  if (const auto sound = directory(); !sound) return tl::unexpected(sound.error());
  return HeldBytes(pack_->chunkIndex(), pack_);
}

Result<HeldBytes> PackStore::chunk(uint32_t number, Waiting) {
  const auto bytes = pack_->chunk(number);
  if (!bytes) return tl::unexpected(bytes.error());
  std::atomic<bool>& sound = chunks_[number].sound;
  if (!sound.load(std::memory_order_relaxed)) {
    if (auto checked = checkedContent(*bytes, "pack: a chunk"); !checked)
      return tl::unexpected(checked.error());
    sound.store(true, std::memory_order_relaxed);
  }
  return HeldBytes(*bytes, pack_);
}

Result<unsigned> PackStore::maxLevel() {
  const auto known = directory();
  if (!known) return tl::unexpected(known.error());
  return (*known)->tables.maxLevel;
}

Result<PackStore::Directory> PackStore::readDirectory() const {
  auto base = decodeBaseMesh(pack_->base());
  if (!base) return tl::unexpected(base.error());
  auto index = decodeChunkIndex(pack_->chunkIndex());
  if (!index) return tl::unexpected(index.error());
  if (index->chunkCount() != pack_->metadata().chunkCount)
    return fail("pack: index and chunks do not belong together; encode the mesh again");
  return Directory{std::move(base->roots), std::move(base->tables), std::move(*index)};
}

Result<const PackStore::Directory*> PackStore::directory() {
  std::call_once(directoryRead_, [this] { directory_ = readDirectory(); });
  if (!directory_) return tl::unexpected(directory_.error());
  return &*directory_;
}

Result<Answer> PackStore::collect(std::span<const NodeId> wanted, const Expansion& expansion,
                                  const CollectLimits& limits, Waiting) {
  const auto known = directory();
  if (!known) return tl::unexpected(known.error());
  Collector collector(*this, **known, limits);
  const auto status =
      expansion.none() ? collector.exactly(wanted) : collector.expanded(wanted, expansion);
  if (!status) return tl::unexpected(status.error());
  return collector.finish();
}

Result<RecordPlace> PackStore::locate(const NodeId& node, const Directory& directory) {
  if (node.tree >= directory.roots.size() || directory.roots[node.tree].isLeaf) return noSuchNode();
  NodeId at = NodeId::root(node.tree);
  unsigned level = directory.roots[node.tree].level;
  {
    const std::shared_lock lock(mutex_);
    for (unsigned depth = node.depth; depth > 0; --depth) {
      const RecordPlace* above = table_.find(node.ancestor(depth - 1));
      if (above == nullptr) continue;
      const bool right = node.step(depth - 1);
      if (above->children().isLeaf(right)) return noSuchNode();
      at = node.ancestor(depth);
      level = above->children().level(right);
      break;
    }
  }
  while (true) {
    auto place = indexChunkOf(at, level, directory);
    if (!place || at.depth == node.depth) return place;
    const bool right = node.step(at.depth);
    if (place->children().isLeaf(right)) return noSuchNode();
    level = place->children().level(right);
    at = at.child(right);
  }
}

Result<RecordPlace> PackStore::indexChunkOf(const NodeId& node, unsigned level,
                                            const Directory& directory) {
  const auto damaged = [] {
    return fail("pack: a record is not in its chunk; encode the mesh again");
  };
  const auto number = directory.chunks.find(node, level);
  if (!number || *number >= chunks_.size()) return damaged();
  {
    const std::shared_lock lock(mutex_);
    if (const RecordPlace* place = table_.find(node)) return *place;
    if (chunks_[*number].indexed) return damaged();
  }
  const auto bytes = pack_->chunk(*number);
  if (!bytes) return tl::unexpected(bytes.error());
  const auto chunk = decodeChunk(*bytes, directory.tables);
  if (!chunk) return tl::unexpected(chunk.error());
  Result<RecordPlace> found = damaged();
  {
    const std::unique_lock lock(mutex_);
    ChunkState& state = chunks_[*number];
    if (!state.indexed) {
      if (!table_.addChunk(*number, chunk->entries)) return damaged();
      state.bytes = *bytes;
      state.indexed = true;
      statistics_->chunksIndexed.fetch_add(1, std::memory_order_relaxed);
      state.used = true;
      indexBytes_ = table_.bytes();
    }
    if (const RecordPlace* place = table_.find(node)) found = *place;
  }
  budget_->enforce();
  return found;
}

void PackStore::release(size_t bytes) {
  const std::unique_lock lock(mutex_);
  const size_t before = table_.bytes();
  const size_t goal = before > bytes ? before - bytes : 0;
  // Two rounds: the first may do no more than clear the used bits.
  for (size_t step = 0; step < 2 * chunks_.size() && table_.bytes() > goal; ++step) {
    const auto number = static_cast<uint32_t>(hand_);
    ChunkState& state = chunks_[hand_];
    hand_ = hand_ + 1 == chunks_.size() ? 0 : hand_ + 1;
    if (!state.indexed || state.used.exchange(false)) continue;
    // Decoding again tells what the chunk added, which costs time here and no memory before.
    if (const auto chunk = decodeChunk(state.bytes, directory_->tables))
      table_.removeChunk(number, chunk->entries);
    state.indexed = false;
    statistics_->chunksForgotten.fetch_add(1, std::memory_order_relaxed);
  }
  indexBytes_ = table_.bytes();
}

}  // namespace meshfront
