// The command line of meshfront-view.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "shared/camera/camera.h"
#include "shared/camera/camera_spec.h"
#include "shared/receiver/receiver_options.h"
#include "shared/scene/scene_file.h"
#include "viewer/run/camera_path.h"
#include "viewer/run/flight.h"
#include "viewer/run/stop_condition.h"
#include "viewer/script/script.h"

namespace meshfront {

struct ViewOptions {
  std::string urlText;           // of a mesh, or a scene file's path
  std::vector<SceneMesh> scene;  // at least one
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
  double timeout = 0;           // seconds; 0 = none
  bool live = false;            // headless: ask as a window does
  uint64_t triangleBudget = 0;  // drawn at a time; 0: none
  uint64_t memoryBudget = 0;    // bytes, of meshes and of what a GPU holds for them; 0: none
  std::optional<std::filesystem::path> cacheDir;
  uint64_t cacheBudget = uint64_t{1} << 30;  // bytes
  bool complete = false;                     // when all that is seen is there: the rest
  bool rim = true;                           // shared/scene/seen_rim.h
  bool foveation = true;                     // in a window
  bool prefetch = true;                      // likewise
  bool geomorph = true;                      // likewise
  int itemDivisor = 1;                       // of the picture's resolution, for ranking
  std::string scriptFile;
  std::vector<ScriptStep> script;  // empty: a person has the window
  std::optional<CameraPathSpec> path;
  FlightPace pace = FlightPace::real;
  bool paceGiven = false;
  bool cameraGiven = false;
  std::optional<std::filesystem::path> frames;   // folder
  std::optional<std::filesystem::path> pathLog;  // CSV
  double interfaceScale = 0;                     // 0 = the display's
};

// Nothing to run (help, version, wrong usage): `exitCode` is set, and what there is to say has been
// said. Else the options.
struct ParsedOptions {
  std::optional<int> exitCode;
  ViewOptions options;
};
[[nodiscard]] ParsedOptions parseViewOptions(int argc, char** argv);

}  // namespace meshfront
