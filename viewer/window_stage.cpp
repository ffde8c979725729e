#include "viewer/window_stage.h"

#include <chrono>

namespace meshfront {

double WindowStage::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool WindowStage::placeCamera(const CameraSpec& spec) {
  const std::optional<SceneView>& scene = window_.scene();
  if (!scene) return false;
  window_.setCamera(meshfront::placeCamera(spec, scene->bounds, window_.pictureSize().aspect()));
  return true;
}

}  // namespace meshfront
