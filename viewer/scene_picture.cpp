#include "viewer/scene_picture.h"

#include <utility>

namespace meshfront {

Result<ScenePicture> ScenePicture::create(PixelSize size, std::span<const SceneMesh> meshes,
                                          PixelCounter::Method countingMethod) {
  auto target = RenderTarget::create(size);
  if (!target) return tl::unexpected(target.error());
  auto drawing = SceneDrawing::create(meshes, countingMethod);
  if (!drawing) return tl::unexpected(drawing.error());
  return ScenePicture(std::move(*target), std::move(*drawing));
}

Result<void> ScenePicture::take(SceneReceiver& scene) {
  const Result<bool> taken = drawing_.take(scene.takeNews(), 0, GpuMesh::kNoLimit);
  if (!taken) return tl::unexpected(taken.error());
  return {};
}

Result<SceneCounts> ScenePicture::count(SceneReceiver& scene, const Camera& camera,
                                        const DrawStyle& style) {
  if (Result<void> taken = take(scene); !taken) return tl::unexpected(taken.error());
  return drawing_.countNow(target_, camera, bounds(), style);
}

Result<void> ScenePicture::draw(SceneReceiver& scene, const Camera& camera,
                                const DrawStyle& style) {
  if (Result<void> taken = take(scene); !taken) return taken;
  drawing_.draw(target_, camera, bounds(), style, false, 0);
  return {};
}

Result<Picture> ScenePicture::drawOther(const MeshArrays& mesh, const Camera& camera,
                                        const DrawStyle& style) {
  GpuMesh other;
  const Result<bool> uploaded = other.update(mesh);
  if (!uploaded) return tl::unexpected(uploaded.error());
  drawing_.renderer().draw(target_, other, camera, bounds(), style);
  return target_.readPicture();
}

}  // namespace meshfront
