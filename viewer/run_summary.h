// What a run of the viewer came to, for people and for scripts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "shared/scene/scene_status.h"
#include "viewer/view_options.h"

namespace meshfront {

// The costs at some moment.
struct Milestone {
  double seconds = 0;
  uint64_t records = 0;
  uint64_t requests = 0;
  uint64_t bytesUp = 0;
  uint64_t bytesDown = 0;
};

struct RunSummary {
  std::string url;
  std::string revision;
  std::string state;       // of the receiver, or "interrupted", "timed out", "target reached"
  std::string reason;      // of degraded
  uint64_t splits = 0;     // records of the whole mesh
  uint64_t triangles = 0;  // drawn
  SceneStatus scene;       // as it was left
  FetchMode mode = FetchMode::exact;
  ReceiverStatistics statistics;
  double seconds = 0;
  std::optional<double> psnr;        // dB; identical pictures: kIdenticalPsnr
  std::optional<double> psnrTarget;  // dB
  std::optional<Milestone> targetReached;
  std::string camera;    // exact spec
  std::string renderer;  // of GL
};

inline constexpr double kIdenticalPsnr = 100;  // stands for infinity, which JSON cannot say

// What the refinement knows; PSNR, target, camera and renderer are left to the caller.
[[nodiscard]] RunSummary summaryOf(const SceneStatus& scene, const ViewOptions& options,
                                   double seconds);
[[nodiscard]] Milestone milestone(const ReceiverStatistics& statistics, double seconds);
[[nodiscard]] std::string toText(const RunSummary& summary);  // lines
[[nodiscard]] std::string toJson(const RunSummary& summary);  // one object, one line

}  // namespace meshfront
