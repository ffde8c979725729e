// Pictures of a scene as it is refined, without a window: takes what has changed, draws, counts,
// and waits for the result.
#pragma once

#include <span>

#include "shared/scene/scene_receiver.h"
#include "viewer/gl/mesh_arrays.h"
#include "viewer/picture/picture.h"
#include "viewer/scene_drawing.h"

namespace meshfront {

class ScenePicture {
 public:
  // Needs a current GL context, which must outlive it.
  [[nodiscard]] static Result<ScenePicture> create(PixelSize size,
                                                   std::span<const SceneMesh> meshes,
                                                   PixelCounter::Method countingMethod);

  // Pixels by vertex slot of the meshes as they are now.
  [[nodiscard]] Result<SceneCounts> count(SceneReceiver& scene, const Camera& camera,
                                          const DrawStyle& style);
  Result<void> draw(SceneReceiver& scene, const Camera& camera, const DrawStyle& style);
  // Of the last draw().
  [[nodiscard]] Picture read() const { return target_.readPicture(); }
  // Draws a mesh in memory the same way into the same target.
  [[nodiscard]] Result<Picture> drawOther(const MeshArrays& mesh, const Camera& camera,
                                          const DrawStyle& style);
  // World; of the meshes taken so far.
  [[nodiscard]] Bounds bounds() const { return drawing_.bounds().value_or(Bounds()); }

 private:
  ScenePicture(RenderTarget target, SceneDrawing drawing)
      : target_(std::move(target)), drawing_(std::move(drawing)) {}
  Result<void> take(SceneReceiver& scene);

  RenderTarget target_;
  SceneDrawing drawing_;
};

}  // namespace meshfront
