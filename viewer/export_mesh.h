// The meshes as refined so far, as a file.
#pragma once

#include <filesystem>

#include "shared/result.h"
#include "shared/scene/scene_receiver.h"

namespace meshfront {

// The fronts' triangles in world coordinates, those of all meshes of the scene as one, as binary
// PLY. Colours and normals of a scene of several meshes only where all have them.
[[nodiscard]] Result<void> exportMesh(const SceneReceiver& scene,
                                      const std::filesystem::path& path);

}  // namespace meshfront
