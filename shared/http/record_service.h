// The HTTP interface over a catalogue of record stores: the same in the service and in the proxy.
//
// A request passes these steps; the first that objects answers:
//   target no longer than allowed (414) -> a resource of the interface (404) -> OPTIONS ->
//   a method it allows (405) -> content within the limit (413) -> the query's spelling (400) ->
//   the mesh, its revision, the nodes or chunk (404) -> the answer -> If-None-Match (304)
#pragma once

#include <array>
#include <functional>
#include <string>

#include "shared/http/catalogue.h"
#include "shared/http/message.h"
#include "shared/http/metrics.h"
#include "shared/http/route.h"
#include "shared/http/split_request.h"

namespace meshfront {

class RecordService final : public HttpHandler {
 public:
  struct Options {
    CollectLimits limits{};
    size_t maxTarget = kMaxTargetOctets;
    size_t maxContent = kMaxContentOctets;  // for the message; the server counts
    size_t maxLevels = kMaxDepth;           // of descendants
    std::string via{};                      // value of the Via field; empty at the origin
    // What the Via fields of a proxy's own sources said, to stand in front of it; empty: nothing.
    std::function<std::string()> viaBefore{};
  };
  // Catalogue and metrics must outlive the service.
  RecordService(Catalogue& catalogue, Metrics& metrics, Options options);

  [[nodiscard]] std::optional<HttpResponse> answerAtOnce(const HttpRequest& request) override;
  [[nodiscard]] HttpResponse answer(const HttpRequest& request) override;
  [[nodiscard]] HttpResponse overloaded(const HttpRequest& request) override;

 private:
  // Unavailable while waiting is refused = ask again.
  [[nodiscard]] Result<HttpResponse> respond(const HttpRequest& request, const Route& route,
                                             Waiting waiting);
  [[nodiscard]] Result<HttpResponse> dispatch(const HttpRequest& request, const Route& route,
                                              Waiting waiting);
  [[nodiscard]] Result<HttpResponse> splits(const HttpRequest& request, const Route& route,
                                            RecordStore& store, Waiting waiting);
  // The fields that every response carries, the conditional request, the counters.
  [[nodiscard]] HttpResponse finish(HttpResponse response, const HttpRequest& request,
                                    const Route& route);

  // Statuses that are counted apart; any other counts as 500.
  static constexpr std::array<unsigned, 13> kStatuses{200, 204, 304, 400, 404, 405, 413,
                                                      414, 415, 502, 503, 504, 500};

  Catalogue& catalogue_;
  Metrics& metrics_;
  const Options options_;
  std::array<std::array<Counter*, kStatuses.size()>, kRouteKinds> requests_{};
  Counter& ids_;
  Counter& records_;
  Counter& recordBytes_;
  Counter& chunkBytes_;
};

}  // namespace meshfront
