#include "proxy/proxy_counters.h"

namespace meshfront {

ProxyCounters::ProxyCounters(Metrics& metrics)
    : upstreamRecordBytes(metrics.counter("meshfront_upstream_record_bytes_total",
                                          "Bytes of upstream answers with records.")),
      wrongAnswers(metrics.counter("meshfront_upstream_wrong_answers_total",
                                   "Upstream responses refused as damaged or not as asked.")),
      recordHits(metrics.counter("meshfront_cache_record_hits_total",
                                 "Records of answers that were in the cache.")),
      recordMisses(metrics.counter("meshfront_cache_record_misses_total",
                                   "Records fetched, or awaited from another's fetch.")),
      sharedFetches(metrics.counter("meshfront_cache_shared_fetches_total",
                                    "Fetches of another request that a request waited for.")),
      documentHits(metrics.counter("meshfront_cache_document_hits_total",
                                   "Base meshes, chunks, indexes and metadata found fresh.")),
      documentMisses(metrics.counter("meshfront_cache_document_misses_total",
                                     "Base meshes, chunks, indexes and metadata asked for.")),
      staleDocuments(metrics.counter("meshfront_cache_stale_documents_total",
                                     "Answers older than allowed, the upstream being away.")) {
  for (const RouteKind kind : {RouteKind::catalogue, RouteKind::mesh, RouteKind::base,
                               RouteKind::splits, RouteKind::chunks, RouteKind::chunk})
    requests_[static_cast<unsigned>(kind)] =
        &metrics.counter("meshfront_upstream_requests_total", "Requests sent upstream, by kind.",
                         std::string("kind=\"") + routeName(kind) + "\"");
}

}  // namespace meshfront
