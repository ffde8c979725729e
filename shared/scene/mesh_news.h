// What became of a mesh of a scene since the last news of it.
#pragma once

#include <cstddef>
#include <optional>

#include "shared/refinement/mesh_update.h"
#include "shared/store/mesh_metadata.h"

namespace meshfront {

struct MeshNews {
  size_t mesh = 0;                         // of the scene
  std::optional<MeshMetadata> introduced;  // the first time
  bool coloured = false;                   // of the introduced one
  MeshUpdate update;
};

}  // namespace meshfront
