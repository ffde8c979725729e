// One request that the cache cannot answer alone: finds out what lacks, fetches it, and puts the
// answer together.
//
// It goes in rounds. A round walks the request over what is known; where a record lacks, the walk
// stops there and notes the *topmost* unknown node on the way to it, because only that one's level
// is known, and without its level a record cannot be read. What was noted is fetched, one request
// for each different rest of the expansion; nodes that another request is fetching are awaited
// instead. Normally the parents of the wanted nodes are cached and one round with one request does;
// after a restart there is a round for each generation that lacks. What a round fetched is held
// here until the answer is done, so that eviction cannot undo it; FetchMemory bounds what all
// gatherings hold so.
#pragma once

#include <future>
#include <map>
#include <mutex>
#include <set>
#include <unordered_map>
#include <vector>

#include "proxy/fetch_memory.h"
#include "proxy/record_cache.h"
#include "proxy/record_fetcher.h"
#include "shared/codec/base_mesh.h"
#include "shared/store/record_store.h"

namespace meshfront {

// The nodes that are being fetched for some request of a mesh.
//
// Locking: `mutex` guards the map, and is held while a node is looked for in the cache and entered
// here. A fetch puts its records into the cache before it leaves the map, so a node is always found
// in one of the two, and nothing is fetched twice.
struct FetchesUnderWay {
  using Fetch = std::shared_ptr<const std::shared_future<Result<SharedRecords>>>;
  std::mutex mutex;
  std::unordered_map<NodeId, Fetch, NodeIdHash> nodes;
};

class RecordGathering {
 public:
  struct Context {
    std::span<const BaseMesh::Root> roots;
    const CodeTables& tables;
    RecordCache& cache;
    RecordFetcher& fetcher;
    FetchesUnderWay& underWay;
    MemoryBudget& budget;
    FetchMemory& memory;
    ProxyCounters& counters;
  };
  // Everything in `context` must outlive the gathering.
  RecordGathering(const Context& context, const CollectLimits& limits)
      : context_(context), limits_(limits), memory_(context.memory.share()) {}

  // May wait.
  [[nodiscard]] Result<Answer> collect(std::span<const NodeId> wanted, const Expansion& expansion);

 private:
  struct Need {
    Expansion rest;
    unsigned level = 0;
  };
  using Needs = std::map<NodeId, Need>;  // in preorder
  struct Batch {
    Expansion expansion;
    std::vector<NodeId> nodes;  // an antichain in preorder
    std::promise<Result<SharedRecords>> promise;
  };
  struct Held {  // entry `entry` of fetched_[fetch]
    uint32_t fetch = 0;
    uint32_t entry = 0;
  };
  using Reader = RecordCache::Reader;

  [[nodiscard]] Result<void> walk(std::span<const NodeId> wanted, const Expansion& expansion,
                                  Needs& needs, FetchMemory::Share& memory);
  [[nodiscard]] std::optional<ChildFacts> find(const NodeId& node, Reader& reader, BitWriter* out);
  [[nodiscard]] Result<void> note(const NodeId& node, const Expansion& rest, Reader& reader,
                                  Needs& needs, FetchMemory::Share& memory);
  [[nodiscard]] Result<void> obtain(const Needs& needs);
  // Enters what nobody fetches yet, as batches; adds the fetches of others to wait for.
  [[nodiscard]] std::vector<Batch> claim(const Needs& needs,
                                         std::set<FetchesUnderWay::Fetch>& others);
  [[nodiscard]] Result<SharedRecords> fetch(const Batch& batch, const Needs& needs);
  void settle(Batch& batch, const Result<SharedRecords>& records);
  [[nodiscard]] Result<void> hold(const SharedRecords& records);

  const Context context_;
  const CollectLimits& limits_;
  FetchMemory::Share memory_;  // for held_
  std::vector<SharedRecords> fetched_;
  NodeTable<Held> held_;
  BitWriter out_;
  uint64_t records_ = 0;
  uint64_t missed_ = 0;  // of these, not from the cache
};

}  // namespace meshfront
