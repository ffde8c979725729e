#include "tests/evaluation/quality/easel.h"

#include <algorithm>
#include <utility>

#include "shared/camera/camera_spec.h"
#include "tests/evaluation/quality/quality_curve.h"

namespace meshfront::evaluation {

Result<EvaluationView> viewNamed(const std::string& name, const MeshMetadata& metadata,
                                 PixelSize size) {
  const Result<CameraSpec> spec = parseCameraSpec(name);
  if (!spec) return tl::unexpected(spec.error());
  EvaluationView view;
  view.name = name;
  view.bounds = Bounds::of(metadata.boundsMin, metadata.boundsMax);
  view.camera = placeCamera(*spec, view.bounds, size.aspect());
  return view;
}

Result<Easel> Easel::create(PixelSize size, PixelCounter::Method method) {
  auto target = RenderTarget::create(size);
  if (!target) return tl::unexpected(target.error());
  auto renderer = MeshRenderer::create();
  if (!renderer) return tl::unexpected(renderer.error());
  return Easel(std::move(*target), std::move(*renderer), PixelCounter::create(method));
}

Canvas::Canvas(Easel& easel, SelectivelyRefinedMesh& mesh, const Quantization& quantization,
               const EvaluationView& view)
    : easel_(&easel),
      mesh_(&mesh),
      view_(&view),
      gpuMesh_(quantization, mesh.attributeLayout().colours) {
  mesh_->stopUpdates();  // of a canvas before
}

Result<void> Canvas::upload() {
  if (gpuMesh_.changeCount() == mesh_->changeCount()) return {};
  const Result<bool> applied = gpuMesh_.apply(mesh_->takeUpdate());
  if (!applied) return tl::unexpected(applied.error());
  return {};
}

Result<Picture> Canvas::draw() {
  if (Result<void> done = upload(); !done) return tl::unexpected(done.error());
  easel_->renderer().draw(easel_->target(), gpuMesh_, view_->camera, view_->bounds, {});
  return easel_->target().readPicture();
}

Result<std::span<const uint32_t>> Canvas::count() {
  if (Result<void> done = upload(); !done) return tl::unexpected(done.error());
  easel_->renderer().drawItems(easel_->target(), gpuMesh_, view_->camera, view_->bounds);
  easel_->counter().count(easel_->target(), gpuMesh_, counts_);
  return std::span<const uint32_t>(counts_);
}

Result<double> psnrOf(const Picture& picture, const Picture& reference) {
  Result<double> psnr = peakSignalToNoise(picture, reference);
  if (!psnr) return psnr;
  return std::min(*psnr, kIdenticalPicturesPsnr);
}

}  // namespace meshfront::evaluation
