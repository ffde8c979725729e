// The command line of meshfront-view.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "shared/camera/camera.h"
#include "shared/camera/camera_spec.h"
#include "shared/receiver/mesh_url.h"
#include "shared/receiver/receiver_options.h"
#include "viewer/run/stop_condition.h"

namespace meshfront {

struct ViewOptions {
  MeshUrl url;
  std::string urlText;
  bool headless = false;
  PixelSize size{1280, 720};
  CameraSpec camera;
  FetchMode mode = FetchMode::exact;
  RankOrder order = RankOrder::significance;
  StopCondition until;
  bool untilGiven = false;
  uint32_t batch = 0;   // records; 0 = adaptive
  uint32_t window = 0;  // requests; 0 = windowOf()
  std::optional<std::filesystem::path> screenshot;
  std::optional<std::filesystem::path> exportPly;
  std::optional<std::filesystem::path> trace;
  std::optional<std::filesystem::path> reference;
  std::optional<double> psnrTarget;  // dB
  bool json = false;
  bool colours = true;  // show the mesh's own, if it has any
  bool countOnCpu = false;
  double timeout = 0;  // seconds; 0 = none
};

// Nothing to run (help, version, wrong usage): `exitCode` is set, and what there is to say has been
// said. Else the options.
struct ParsedOptions {
  std::optional<int> exitCode;
  ViewOptions options;
};
[[nodiscard]] ParsedOptions parseViewOptions(int argc, char** argv);

}  // namespace meshfront
