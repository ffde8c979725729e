// What a scene's refinement tells of itself: numbers for a panel, a script, a summary.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/receiver/receiver.h"

namespace meshfront {

struct MeshProgress {
  std::string name;
  ReceiverState state = ReceiverState::connecting;
  std::string reason;  // of degraded
  std::string revision;
  uint64_t triangles = 0;  // drawn
  uint64_t trianglesOfMesh = 0;
  uint64_t splits = 0;       // in the front
  uint64_t splitCount = 0;   // of the whole mesh; 0 while connecting
  uint64_t recordsHeld = 0;  // distinct ones in memory
};

struct SceneStatus {
  ReceiverState state = ReceiverState::connecting;  // of all: the worst of them
  std::string reason;                               // of degraded, and the mesh's name
  std::vector<MeshProgress> meshes;
  // Sums over the meshes.
  ReceiverStatistics statistics;
  uint64_t triangles = 0;
  uint64_t trianglesOfMesh = 0;
  uint64_t splits = 0;
  uint64_t splitCount = 0;
  uint64_t recordsHeld = 0;
  uint64_t requestsUnderWay = 0;
  uint64_t visibleCandidates = 0;  // that could be split, at the last ranking
  uint64_t cpuBytes = 0;           // of the meshes
  uint64_t gpuBytes = 0;           // that a drawer needs for them
  uint64_t collapses = 0;
  uint64_t resplits = 0;  // from kept records
  // Corners of covered pixels at vertices that are final, 0 .. 1, at the last ranking: 1 when what
  // is seen is exact.
  double finalShare = 0;
  std::optional<double> roundTripSeconds;  // of the slowest service
  double bytesPerSecond = 0;               // what the services' links were seen to carry
  bool offline = false;  // a service is away, and what the disk cache holds is shown
  std::optional<double> secondsToResume;  // while a server is away
};

}  // namespace meshfront
