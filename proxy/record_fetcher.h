// Asks the upstream for records and hands over none that are not checked.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "proxy/proxy_counters.h"
#include "proxy/upstream.h"
#include "shared/codec/answer.h"
#include "shared/store/record_store.h"

namespace meshfront {

struct FetchedRecords {
  std::vector<uint8_t> bytes;
  std::vector<RecordEntry> entries;  // offsets into bytes
  FetchMemory::Share memory;         // for both
};
using SharedRecords = std::shared_ptr<const FetchedRecords>;

class RecordFetcher {
 public:
  RecordFetcher(Upstream& upstream, FetchMemory& memory, ProxyCounters& counters, std::string mesh,
                std::string revision)
      : upstream_(upstream),
        memory_(memory),
        counters_(counters),
        mesh_(std::move(mesh)),
        revision_(std::move(revision)) {}

  // One request: GET, or QUERY where the URL would be too long. A wrong answer is asked for once
  // more, then it counts as unavailable. `wanted`: an antichain in preorder, not empty. No more is
  // taken in than `limits` let anybody have.
  [[nodiscard]] Result<SharedRecords> fetch(
      std::span<const NodeId> wanted, const Expansion& expansion, const CodeTables& tables,
      const std::function<std::optional<unsigned>(const NodeId&)>& levelOf,
      const CollectLimits& limits);

 private:
  [[nodiscard]] UpstreamRequest requestFor(std::vector<uint8_t> bitstring,
                                           const Expansion& expansion) const;

  // Nothing where the response is not what was asked for.
  [[nodiscard]] Result<std::optional<SharedRecords>> check(
      UpstreamResponse response, std::span<const NodeId> wanted, const Expansion& expansion,
      const CodeTables& tables,
      const std::function<std::optional<unsigned>(const NodeId&)>& levelOf,
      const CollectLimits& limits, uint32_t key);

  Upstream& upstream_;
  FetchMemory& memory_;
  ProxyCounters& counters_;
  const std::string mesh_;
  const std::string revision_;
};

}  // namespace meshfront
