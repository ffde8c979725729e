// What a drawer saw: the pixels that each front vertex of each mesh covers, from where, and which
// state of the meshes it had drawn. Counts may lag behind: the frame before is good enough.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/camera/camera.h"

namespace meshfront {

struct MeshCounts {
  uint64_t changeCount = 0;      // of the MeshUpdate that was drawn last
  std::vector<uint32_t> pixels;  // by vertex slot; slots beyond it cover nothing
};

struct SceneCounts {
  std::vector<MeshCounts> meshes;  // by mesh of the scene; empty for one that is not there yet
  Camera camera;
  PixelSize picture;
  bool ahead = false;  // of a view that may come
};

}  // namespace meshfront
