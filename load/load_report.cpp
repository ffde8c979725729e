#include "load/load_report.h"

#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

namespace meshfront {
namespace {

double ratio(double part, double whole) {
  return whole > 0 ? part / whole : 0;
}

uint64_t errorCount(const TransportCounts& counts) {
  uint64_t sum = 0;
  for (const auto& [kind, count] : counts.errors) sum += count;
  return sum;
}

nlohmann::ordered_json percentilesJson(const DurationPercentiles& durations) {
  return {{"p50", durations.percentile(50)},
          {"p90", durations.percentile(90)},
          {"p99", durations.percentile(99)},
          {"max", durations.longest()}};
}

std::string percentilesText(const DurationPercentiles& durations) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << durations.percentile(50) << " / "
       << durations.percentile(90) << " / " << durations.percentile(99) << " / "
       << durations.longest() << " s (50 / 90 / 99 % / longest)";
  return text.str();
}

}  // namespace

double recordBytesServed(const MetricsSpan& span) {
  return span.grown("meshfront_record_bytes_total") + span.grown("meshfront_chunk_bytes_total");
}

std::string progressLine(const LoadResult& result, const TransportCounts& counts,
                         const TransportCounts& aSecondAgo) {
  const uint64_t down = counts.traffic.bytesDown() - aSecondAgo.traffic.bytesDown();
  std::ostringstream text;
  text << std::fixed << std::setprecision(0) << std::setw(5) << result.seconds << " s  "
       << result.started << " started, " << result.settled << " settled, " << result.failed
       << " failed, " << result.unfinished << " alive; " << counts.requests - aSecondAgo.requests
       << " requests/s, " << std::setprecision(2) << static_cast<double>(down) / 1e6 << " MB/s, "
       << errorCount(counts) << " errors";
  return text.str();
}

std::string toText(const LoadReport& report) {
  const LoadResult& result = report.result;
  const TransportCounts& counts = report.transport;
  std::ostringstream text;
  text << std::fixed << std::setprecision(1);
  text << "receivers  " << result.started << " started, " << result.settled << " settled ("
       << result.complete << " with the whole mesh), " << result.failed << " failed, "
       << result.unfinished << " given up; at most " << result.mostAlive << " at a time";
  for (const auto& [reason, count] : result.failures)
    text << "\n           " << count << ": " << reason;
  text << "\ntime       " << result.seconds << " s; "
       << ratio(static_cast<double>(result.settled), result.seconds) << " receivers/s, "
       << ratio(static_cast<double>(counts.requests), result.seconds) << " requests/s";
  text << "\nsettling   " << percentilesText(result.settling);
  text << "\nlatency    " << percentilesText(counts.latency) << " of a request";
  text << "\nrequests   " << counts.requests << "; " << counts.repeated << " attempts repeated";
  text << "\nbytes      " << counts.traffic.bytesDown() << " down (" << counts.recordBytes
       << " of records), " << counts.traffic.bytesUp << " up";
  text << "\nrecords    " << result.records;
  text << "\nerrors     " << errorCount(counts);
  for (const auto& [kind, count] : counts.errors) text << "; " << count << " " << kind;
  if (result.malformed > 0) text << "; " << result.malformed << " damaged answers";
  if (result.resumed > 0) text << "; resumed " << result.resumed << " times";
  const auto received = static_cast<double>(counts.recordBytes);
  if (report.origin) {
    const double served = recordBytesServed(*report.origin);
    text << "\norigin     " << std::setprecision(0) << served << " bytes of records, "
         << std::setprecision(3) << 100 * ratio(served, received) << " % of what receivers got";
  }
  if (report.proxy) {
    text << "\nproxy      " << std::setprecision(0) << recordBytesServed(*report.proxy)
         << " bytes of records served, "
         << report.proxy->grown("meshfront_upstream_record_bytes_total") << " fetched";
  }
  text << "\nmemory     " << std::setprecision(1) << static_cast<double>(report.peakMemory) / 0x1p20
       << " MiB at most, "
       << ratio(static_cast<double>(report.peakMemory) / 0x1p20,
                static_cast<double>(result.mostAlive))
       << " a receiver alive\n";
  return text.str();
}

std::string toJson(const LoadReport& report) {
  const LoadResult& result = report.result;
  const TransportCounts& counts = report.transport;
  nlohmann::ordered_json json{
      {"url", report.options->urlText},
      {"fetch", fetchModeName(report.options->run.receiver.mode)},
      {"receivers", report.options->run.receivers},
      {"started", result.started},
      {"settled", result.settled},
      {"complete", result.complete},
      {"failed", result.failed},
      {"unfinished", result.unfinished},
      {"resumed", result.resumed},
      {"most_alive", result.mostAlive},
      {"seconds", result.seconds},
      {"requests", counts.requests},
      {"repeated_attempts", counts.repeated},
      {"records", result.records},
      {"bytes_down", counts.traffic.bytesDown()},
      {"bytes_up", counts.traffic.bytesUp},
      {"record_bytes", counts.recordBytes},
      {"malformed_answers", result.malformed},
      {"errors", counts.errors},
      {"failures", result.failures},
      {"settled_seconds", percentilesJson(result.settling)},
      {"latency_seconds", percentilesJson(counts.latency)},
      {"peak_memory_bytes", report.peakMemory},
  };
  const auto received = static_cast<double>(counts.recordBytes);
  if (report.origin) {
    const double served = recordBytesServed(*report.origin);
    json["origin"] = {{"record_bytes", served}, {"share", ratio(served, received)}};
  }
  if (report.proxy) {
    json["proxy"] = {
        {"record_bytes", recordBytesServed(*report.proxy)},
        {"upstream_record_bytes", report.proxy->grown("meshfront_upstream_record_bytes_total")}};
  }
  return json.dump();
}

}  // namespace meshfront
