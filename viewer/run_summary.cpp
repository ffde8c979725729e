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

RunSummary summaryOf(const SceneStatus& scene, const ViewOptions& options, double seconds) {
  RunSummary summary;
  summary.url = options.urlText;
  summary.state = stateName(scene.state);
  summary.reason = scene.reason;
  summary.mode = options.mode;
  summary.statistics = scene.statistics;
  summary.seconds = seconds;
  if (!scene.meshes.empty()) summary.revision = scene.meshes.front().revision;
  summary.splits = scene.splitCount;
  summary.triangles = scene.triangles;
  summary.scene = scene;
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
  if (summary.scene.collapses + summary.scene.resplits > 0)
    text << "; " << summary.scene.collapses << " times collapsed, " << summary.scene.resplits
         << " times split again";
  if (is.recordsFromDisk > 0) text << "\nfrom disk  " << is.recordsFromDisk << " records";
  text << "\nmemory     " << (summary.scene.cpuBytes + summary.scene.gpuBytes) / 1'000'000
       << " MB, " << summary.scene.gpuBytes / 1'000'000 << " of these on the GPU";
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
      {"splits", summary.scene.splits},
      {"collapses", summary.scene.collapses},
      {"resplits", summary.scene.resplits},
      {"records_from_disk", is.recordsFromDisk},
      {"cpu_bytes", summary.scene.cpuBytes},
      {"gpu_bytes", summary.scene.gpuBytes},
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
  if (summary.scene.meshes.size() > 1) {
    for (const MeshProgress& mesh : summary.scene.meshes) {
      json["meshes"].push_back({{"name", mesh.name},
                                {"revision", mesh.revision},
                                {"state", stateName(mesh.state)},
                                {"triangles", mesh.triangles},
                                {"splits", mesh.splits},
                                {"records_of_mesh", mesh.splitCount}});
    }
  }
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
