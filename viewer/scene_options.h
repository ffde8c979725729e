// What the command line says of refining.
#pragma once

#include "shared/scene/scene_receiver.h"
#include "viewer/gl/mesh_renderer.h"
#include "viewer/view_options.h"

namespace meshfront {

// Of a window: what depends on time is on (receiver_options.h). Of pictures without one: requests
// depend on the meshes and the views alone.
[[nodiscard]] SceneOptions windowSceneOptions(const ViewOptions& options);
[[nodiscard]] SceneOptions pictureSceneOptions(const ViewOptions& options);
// For a title: the mesh's name, or the scene file's.
[[nodiscard]] std::string titleOf(const ViewOptions& options);

}  // namespace meshfront
