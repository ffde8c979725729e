#include "shared/http/server/front_metrics.h"

namespace meshfront {

FrontMetrics::FrontMetrics(Metrics& metrics, const std::shared_ptr<const InFlight>& inFlight)
    : requestSeconds(metrics.histogram(
          "meshfront_request_seconds",
          "Time from a request's first line until its answer was handed to the kernel.",
          kLatencyBounds)),
      connections(metrics.counter("meshfront_connections_total", "Connections accepted.")),
      unfinished(metrics.counter("meshfront_unfinished_total",
                                 "Requests that ended before their answer was sent.")) {
  const auto refusedFor = [&](const char* reason) {
    return &metrics.counter("meshfront_refused_total",
                            "Requests refused whatever they ask for: fields too long (header), too "
                            "many connections from the address, too many in all (connections), too "
                            "much memory in flight, a URL beyond 64 KiB (target), no sound request "
                            "of HTTP/1.1 (malformed).",
                            std::string("reason=\"") + reason + "\"");
  };
  refused_ = {refusedFor("header"), refusedFor("address"), refusedFor("connections"),
              refusedFor("memory"), refusedFor("target"),  refusedFor("malformed")};
  const auto cutIn = [&](const char* phase) {
    return &metrics.counter("meshfront_cut_total",
                            "Connections cut because line, header, content or answer took too "
                            "long, or because a refused one never asked (idle).",
                            std::string("phase=\"") + phase + "\"");
  };
  cut_ = {cutIn("idle"), cutIn("line"), cutIn("header"), cutIn("content"), cutIn("answer")};
  metrics.gauge("meshfront_requests_in_flight", "Requests between their first line and their end.",
                [inFlight] { return inFlight->requests.load(); });
  metrics.gauge("meshfront_in_flight_bytes",
                "Contents received for and answers not yet sent of the requests in flight.",
                [inFlight] { return inFlight->bytes(); });
  metrics.gauge("meshfront_connections_open", "Open connections.",
                [inFlight] { return inFlight->connections.load(); });
}

}  // namespace meshfront
