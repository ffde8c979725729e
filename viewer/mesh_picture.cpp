#include "viewer/mesh_picture.h"

#include <utility>

namespace meshfront {

Result<MeshPicture> MeshPicture::create(PixelSize size, const Quantization& quantization,
                                        const Bounds& bounds, PixelCounter::Method countingMethod) {
  auto target = RenderTarget::create(size);
  if (!target) return tl::unexpected(target.error());
  auto renderer = MeshRenderer::create();
  if (!renderer) return tl::unexpected(renderer.error());
  return MeshPicture(std::move(*target), std::move(*renderer), PixelCounter::create(countingMethod),
                     quantization, bounds);
}

Result<void> MeshPicture::upload(const SelectivelyRefinedMesh& mesh) {
  const Result<bool> uploaded = gpuMesh_.update(
      {quantization_, mesh.positions(), mesh.drawnCorners(), mesh.changeCount(), mesh.coloured()});
  if (!uploaded) return tl::unexpected(uploaded.error());
  return {};
}

Result<std::span<const uint32_t>> MeshPicture::count(const SelectivelyRefinedMesh& mesh,
                                                     const Camera& camera) {
  if (Result<void> uploaded = upload(mesh); !uploaded) return tl::unexpected(uploaded.error());
  renderer_.drawItems(target_, gpuMesh_, camera, bounds_);
  counter_.count(target_, gpuMesh_, counts_);
  return counts_;
}

Result<void> MeshPicture::draw(const SelectivelyRefinedMesh& mesh, const Camera& camera,
                               const DrawStyle& style) {
  if (Result<void> uploaded = upload(mesh); !uploaded) return uploaded;
  renderer_.draw(target_, gpuMesh_, camera, bounds_, style);
  return {};
}

Result<Picture> MeshPicture::drawOther(const MeshArrays& mesh, const Camera& camera,
                                       const DrawStyle& style) {
  GpuMesh other;
  const Result<bool> uploaded = other.update(mesh);
  if (!uploaded) return tl::unexpected(uploaded.error());
  renderer_.draw(target_, other, camera, bounds_, style);
  return target_.readPicture();
}

}  // namespace meshfront
