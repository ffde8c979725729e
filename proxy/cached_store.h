// The record store of the proxy: one mesh revision, its records cached one by one, so that any
// request can be answered whose records were part of any earlier ones.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "proxy/document_cache.h"
#include "proxy/record_cache.h"
#include "proxy/record_fetcher.h"
#include "proxy/record_gathering.h"
#include "shared/codec/base_mesh.h"
#include "shared/store/record_store.h"

namespace meshfront {

class CachedStore final : public RecordStore {
 public:
  struct Parts {
    Upstream& upstream;
    DocumentCache& documents;
    MemoryBudget& budget;
    FetchMemory& memory;
    ProxyCounters& counters;
  };
  // Fetches and decodes the base mesh, which also tells whether the revision exists. All parts must
  // outlive the store.
  [[nodiscard]] static Result<std::shared_ptr<CachedStore>> open(const Parts& parts,
                                                                 const std::string& mesh,
                                                                 const std::string& revision,
                                                                 Waiting waiting);

  [[nodiscard]] Result<HeldBytes> base(Waiting waiting) override;
  [[nodiscard]] Result<HeldBytes> chunkIndex(Waiting waiting) override;
  [[nodiscard]] Result<HeldBytes> chunk(uint32_t number, Waiting waiting) override;
  [[nodiscard]] Result<Answer> collect(std::span<const NodeId> wanted, const Expansion& expansion,
                                       const CollectLimits& limits, Waiting waiting) override;
  [[nodiscard]] Result<unsigned> maxLevel() override { return tables_->maxLevel; }
  // Since the first response of this revision: nothing held is older.
  [[nodiscard]] std::optional<std::chrono::seconds> age() const override;

 private:
  CachedStore(const Parts& parts, const std::string& mesh, const std::string& revision,
              BaseMesh base, std::chrono::seconds age);
  [[nodiscard]] Result<HeldBytes> document(const std::string& resource, RouteKind kind,
                                           Waiting waiting);
  // The answer where every record is cached.
  [[nodiscard]] Result<std::optional<Answer>> collectCached(std::span<const NodeId> wanted,
                                                            const Expansion& expansion,
                                                            const CollectLimits& limits);

  const Parts parts_;
  const std::string prefix_;  // "/v1/meshes/{mesh}/{revision}/"
  const std::string revision_;
  const std::vector<BaseMesh::Root> roots_;
  const std::shared_ptr<const CodeTables> tables_;
  const std::chrono::steady_clock::time_point opened_;
  RecordCache cache_;
  RecordFetcher fetcher_;
  FetchesUnderWay underWay_;
};

}  // namespace meshfront
