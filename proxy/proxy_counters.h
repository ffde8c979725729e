// What a proxy counts beside the requests it answers. The names are those of /metrics.
#pragma once

#include <array>

#include "shared/http/metrics.h"
#include "shared/http/route.h"

namespace meshfront {

struct ProxyCounters {
  explicit ProxyCounters(Metrics& metrics);

  // meshfront_upstream_requests_total{kind=...}; splits counts GET and QUERY alike. Attempts that a
  // broken connection made necessary again count once.
  Counter& upstreamRequests(RouteKind kind) { return *requests_[static_cast<unsigned>(kind)]; }

  Counter& upstreamRecordBytes;  // bytes of upstream answers with records
  Counter& wrongAnswers;         // upstream responses refused: damaged, short, not what was asked
  Counter& recordHits;           // records of answers that were in the cache
  Counter& recordMisses;         // records fetched, or awaited from another request's fetch
  Counter& sharedFetches;        // fetches of other requests that a request waited for
  Counter& documentHits;         // base meshes, chunks, indexes, metadata found fresh
  Counter& documentMisses;
  Counter& staleDocuments;  // answered although older than allowed, because the upstream was away

 private:
  std::array<Counter*, kRouteKinds> requests_{};
};

}  // namespace meshfront
