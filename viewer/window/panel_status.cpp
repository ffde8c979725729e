#include "viewer/window/panel_status.h"

#include <nlohmann/json.hpp>

namespace meshfront {
namespace {

using Json = nlohmann::ordered_json;

template <typename Value>
Json orNull(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json budgetJson(const BudgetUse& use) {
  return {{"used", use.used}, {"limit", use.limit == 0 ? Json(nullptr) : Json(use.limit)}};
}

Json meshesJson(const std::vector<MeshStatus>& meshes) {
  Json list = Json::array();
  for (const MeshStatus& mesh : meshes) {
    list.push_back({{"name", mesh.name},
                    {"state", mesh.state},
                    {"triangles_shown", mesh.trianglesShown},
                    {"triangles_of_mesh", mesh.trianglesOfMesh},
                    {"reason", mesh.reason}});
  }
  return list;
}

Json legendJson(const Legend& legend) {
  Json entries = Json::array();
  for (const LegendEntry& entry : legend.entries) {
    entries.push_back({{"colour", entry.colour}, {"text", entry.text}});
  }
  return {{"title", legend.title}, {"ramp", legend.ramp}, {"entries", std::move(entries)}};
}

Json picksJson(const std::vector<PickedPoint>& picks) {
  Json list = Json::array();
  for (const PickedPoint& pick : picks) {
    list.push_back({{"world", {pick.world.x, pick.world.y, pick.world.z}},
                    {"mesh", pick.mesh},
                    {"node", pick.node},
                    {"local_error", orNull(pick.localError)}});
  }
  return list;
}

Json qualityJson(const std::vector<QualitySample>& quality) {
  Json list = Json::array();
  for (const QualitySample& sample : quality) list.push_back({sample.seconds, sample.share});
  return list;
}

Json messageJson(const std::optional<WindowMessage>& message) {
  if (!message) return nullptr;
  return {{"title", message->title}, {"detail", message->detail}, {"advice", message->advice}};
}

}  // namespace

std::string toJson(const PanelStatus& status) {
  const bool known = !status.quality.empty();
  const Json json{
      {"state", status.state},
      {"reason", status.reason},
      {"offline", status.offline},
      {"retry_in", orNull(status.retryIn)},
      {"message", messageJson(status.message)},
      {"triangles_shown", status.trianglesShown},
      {"triangles_held", status.trianglesHeld},
      {"triangles_of_mesh", status.trianglesOfMesh},
      {"records", status.records},
      {"records_of_mesh", status.recordsOfMesh},
      {"triangle_budget", budgetJson(status.triangleBudget)},
      {"byte_budget", budgetJson(status.byteBudget)},
      {"bytes_down", status.bytesDown},
      {"bytes_up", status.bytesUp},
      {"requests", status.requests},
      {"requests_under_way", status.requestsUnderWay},
      {"collapses", status.collapses},
      {"resplits", status.resplits},
      {"splits_per_second", orNull(status.splitsPerSecond)},
      {"bits_per_split", orNull(status.bitsPerSplit)},
      {"cache_share", orNull(status.cacheShare)},
      {"network_cache_share", orNull(status.networkCacheShare)},
      {"round_trip", orNull(status.roundTrip)},
      {"ranking_time", orNull(status.rankingTime)},
      {"quality", known ? Json(status.quality.back().share) : Json(nullptr)},
      {"quality_series", qualityJson(status.quality)},
      {"meshes", meshesJson(status.meshes)},
      {"legend", legendJson(status.legend)},
      {"frame_median", status.frame ? Json(status.frame->median) : Json(nullptr)},
      {"frame_95", status.frame ? Json(status.frame->slow) : Json(nullptr)},
      {"frames_measured", status.frame ? status.frame->frames : 0},
      {"pictures_drawn", status.picturesDrawn},
      {"picture_size", status.pictureSize},
      {"camera", status.camera},
      {"shading", status.shading},
      {"colouring", status.colouring},
      {"wireframe", status.wireframe},
      {"missing_bounds", status.missingBounds},
      {"geomorph", status.geomorph},
      {"panel_shown", status.panelShown},
      {"help_shown", status.helpShown},
      {"picks", picksJson(status.picks)},
      {"picks_made", status.picksMade},
      {"pick_distance", orNull(status.pickDistance)},
      {"note", status.note},
  };
  // What a server or a file name says may be no UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace meshfront
