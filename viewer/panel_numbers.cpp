#include "viewer/panel_numbers.h"

#include <algorithm>

#include "viewer/gl/colour_scales.h"
#include "viewer/window/trouble_message.h"

namespace meshfront {

void PanelNumbers::observe(const SceneStatus& scene, double seconds) {
  scene_ = scene;
  if (scene.triangles > 0) quality_.add(seconds, scene.finalShare);
  splits_.add(seconds, scene.statistics.records + scene.resplits);
}

std::optional<WindowMessage> PanelNumbers::message(double seconds) const {
  const bool shown = scene_.triangles > 0;
  if (scene_.state == ReceiverState::degraded)
    return troubleMessage(troubleKindOf(scene_.reason), scene_.reason, options_.urlText, shown,
                          scene_.secondsToResume);
  if (!shown && scene_.state == ReceiverState::connecting)
    return connectingMessage(options_.urlText, seconds);
  return std::nullopt;
}

PanelStatus PanelNumbers::status(double seconds, double ranking) const {
  const ReceiverStatistics& is = scene_.statistics;
  PanelStatus status;
  status.state = stateName(scene_.state);
  status.reason = scene_.reason;
  status.offline = scene_.offline;
  status.retryIn = scene_.secondsToResume;
  status.message = message(seconds);
  status.trianglesShown = scene_.triangles;
  // Each record that is kept and not split stands for two triangles.
  status.trianglesHeld =
      scene_.triangles + 2 * (scene_.recordsHeld - std::min(scene_.recordsHeld, scene_.splits));
  status.trianglesOfMesh = scene_.trianglesOfMesh;
  status.records = scene_.recordsHeld;
  status.recordsOfMesh = scene_.splitCount;
  status.triangleBudget = {scene_.triangles, options_.triangleBudget};
  status.byteBudget = {scene_.cpuBytes + scene_.gpuBytes, options_.memoryBudget};
  status.bytesDown = is.traffic.bytesDown();
  status.bytesUp = is.traffic.bytesUp;
  status.requests = is.requests;
  status.requestsUnderWay = scene_.requestsUnderWay;
  status.collapses = scene_.collapses;
  status.resplits = scene_.resplits;
  status.splitsPerSecond = splits_.perSecond();
  const uint64_t fetched = is.records - std::min(is.records, is.recordsFromDisk);
  if (fetched > 0)
    status.bitsPerSplit =
        8 * static_cast<double>(is.answerBytesDown) / static_cast<double>(fetched);
  if (options_.cacheDir && is.records > 0)
    status.cacheShare = static_cast<double>(is.recordsFromDisk) / static_cast<double>(is.records);
  if (is.answers > 0)
    status.networkCacheShare =
        static_cast<double>(is.answersFromCaches) / static_cast<double>(is.answers);
  status.roundTrip = scene_.roundTripSeconds;
  if (ranking > 0) status.rankingTime = ranking;
  status.quality = quality_.samples();
  if (scene_.meshes.size() > 1) {
    for (const MeshProgress& mesh : scene_.meshes) {
      MeshStatus& line = status.meshes.emplace_back();
      line.name = mesh.name;
      line.state = stateName(mesh.state);
      line.trianglesShown = mesh.triangles;
      line.trianglesOfMesh = mesh.trianglesOfMesh;
      line.reason = mesh.reason;
    }
  }
  return status;
}

Legend legendOf(Colouring colouring, unsigned finestLevel) {
  Legend legend;
  switch (colouring) {
    case Colouring::surface:
      break;
    case Colouring::tree:
      legend.title = "a colour for each tree of the hierarchy";
      break;
    case Colouring::level:
      legend.title = "significance level";
      legend.ramp = true;
      for (unsigned i = 0; i <= 4; ++i) {
        const unsigned level = finestLevel * i / 4;
        legend.entries.push_back({levelColour(level, finestLevel), std::to_string(level)});
      }
      break;
    case Colouring::pixels:
      legend.title = "pixels of a vertex's triangles";
      legend.ramp = true;
      for (const unsigned pixels : {1U, 6U, 32U, 180U, 1'023U})
        legend.entries.push_back({pixelColour(pixels), std::to_string(pixels)});
      break;
    case Colouring::missing:
      legend.title = "still missing";
      legend.entries.push_back({missingColour(0, finestLevel, true), "final"});
      legend.entries.push_back({missingColour(finestLevel, finestLevel, false), "little"});
      legend.entries.push_back({missingColour(finestLevel / 2, finestLevel, false), ""});
      legend.entries.push_back({missingColour(0, finestLevel, false), "much"});
      break;
  }
  return legend;
}

}  // namespace meshfront
