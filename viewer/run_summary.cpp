#include "viewer/run_summary.h"

#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

namespace meshfront {
namespace {

double share(uint64_t records, uint64_t splits) {
  return splits == 0 ? 1 : static_cast<double>(records) / static_cast<double>(splits);
}

std::string decibels(double psnr) {
  if (psnr >= kIdenticalPsnr) return "identical";
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << psnr << " dB";
  return text.str();
}

}  // namespace

RunSummary summaryOf(const Receiver& receiver, const std::string& url, double seconds) {
  RunSummary summary;
  summary.url = url;
  summary.state = stateName(receiver.state());
  summary.reason = receiver.reason();
  summary.mode = receiver.mode();
  summary.statistics = receiver.statistics();
  summary.seconds = seconds;
  if (const MeshMetadata* metadata = receiver.metadata()) {
    summary.revision = metadata->revision;
    summary.splits = metadata->splitCount;
  }
  if (receiver.mesh() != nullptr) summary.triangles = receiver.mesh()->drawnTriangleCount();
  return summary;
}

Milestone milestone(const ReceiverStatistics& statistics, double seconds) {
  return {seconds, statistics.records, statistics.requests, statistics.traffic.bytesUp,
          statistics.traffic.bytesDown()};
}

std::string toText(const RunSummary& summary) {
  const ReceiverStatistics& is = summary.statistics;
  std::ostringstream text;
  text << std::fixed << std::setprecision(2);
  text << "state      " << summary.state;
  if (!summary.reason.empty()) text << ": " << summary.reason;
  text << "\nrecords    " << is.records << " of " << summary.splits << " ("
       << 100 * share(is.records, summary.splits) << " %)";
  if (is.recordsWhenSettled && *is.recordsWhenSettled != is.records)
    text << "; " << *is.recordsWhenSettled << " when the view had settled";
  text << "\ntriangles  " << summary.triangles;
  text << "\nrequests   " << is.requests
       << (summary.mode == FetchMode::chunks ? " for chunks, " : " for records, ")
       << is.traffic.attempts << " in all";
  text << "\nbytes up   " << is.traffic.bytesUp;
  if (is.idsRequested > 0)
    text << " (sets of IDs: " << 8 * share(is.setOctets, is.idsRequested) << " bits an ID)";
  text << "\nbytes down " << is.traffic.bytesDown() << " (" << is.answerBytesDown << " of records, "
       << is.traffic.headerBytesDown << " of headers)";
  if (summary.psnr) text << "\nPSNR       " << decibels(*summary.psnr);
  if (summary.psnrTarget) {
    text << "\ntarget     " << decibels(*summary.psnrTarget);
    if (const auto& reached = summary.targetReached) {
      text << " reached with " << reached->records << " records ("
           << 100 * share(reached->records, summary.splits) << " %), " << reached->bytesDown
           << " bytes down, " << reached->bytesUp << " up, after " << reached->seconds << " s";
    } else {
      text << " not reached";
    }
  }
  text << "\ncamera     " << summary.camera;
  text << "\ndrawn with " << summary.renderer;
  text << "\ntime       " << summary.seconds << " s\n";
  return text.str();
}

std::string toJson(const RunSummary& summary) {
  const ReceiverStatistics& is = summary.statistics;
  nlohmann::ordered_json json{
      {"url", summary.url},
      {"revision", summary.revision},
      {"state", summary.state},
      {"fetch", fetchModeName(summary.mode)},
      {"records", is.records},
      {"records_of_mesh", summary.splits},
      {"share", share(is.records, summary.splits)},
      {"triangles", summary.triangles},
      {"requests", is.requests},
      {"http_requests", is.traffic.attempts},
      {"bytes_up", is.traffic.bytesUp},
      {"bytes_down", is.traffic.bytesDown()},
      {"header_bytes_down", is.traffic.headerBytesDown},
      {"record_bytes_down", is.answerBytesDown},
      {"request_bytes_up", is.requestBytesUp},
      {"ids_requested", is.idsRequested},
      {"set_octets", is.setOctets},
      {"malformed_answers", is.malformed},
      {"seconds", summary.seconds},
      {"camera", summary.camera},
      {"renderer", summary.renderer},
  };
  if (!summary.reason.empty()) json["reason"] = summary.reason;
  if (is.recordsWhenSettled) json["records_when_settled"] = *is.recordsWhenSettled;
  if (summary.psnr) json["psnr"] = *summary.psnr;
  if (summary.psnrTarget) {
    nlohmann::ordered_json target{{"db", *summary.psnrTarget},
                                  {"reached", summary.targetReached.has_value()}};
    if (const auto& reached = summary.targetReached) {
      target["records"] = reached->records;
      target["share"] = share(reached->records, summary.splits);
      target["requests"] = reached->requests;
      target["bytes_up"] = reached->bytesUp;
      target["bytes_down"] = reached->bytesDown;
      target["seconds"] = reached->seconds;
    }
    json["psnr_target"] = std::move(target);
  }
  return json.dump();
}

}  // namespace meshfront
