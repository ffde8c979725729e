// Pictures of a mesh while it is refined, and the pixels that its vertices cover: drawn and counted
// by the viewer's own renderer.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/camera/bounds.h"
#include "shared/camera/camera.h"
#include "shared/refinement/selectively_refined_mesh.h"
#include "shared/result.h"
#include "shared/store/mesh_metadata.h"
#include "viewer/gl/gpu_mesh.h"
#include "viewer/gl/mesh_renderer.h"
#include "viewer/gl/pixel_counter.h"
#include "viewer/gl/render_target.h"
#include "viewer/picture/picture.h"

namespace meshfront::evaluation {

struct EvaluationView {
  std::string name;  // as --camera has it
  Camera camera;
  Bounds bounds;
};
[[nodiscard]] Result<EvaluationView> viewNamed(const std::string& name,
                                               const MeshMetadata& metadata, PixelSize size);

// Needs a current GL context, which must outlive it. One for all runs of a size.
class Easel {
 public:
  [[nodiscard]] static Result<Easel> create(PixelSize size, PixelCounter::Method method);

  [[nodiscard]] PixelSize size() const { return target_.size(); }
  [[nodiscard]] const MeshRenderer& renderer() const { return renderer_; }
  [[nodiscard]] RenderTarget& target() { return target_; }
  [[nodiscard]] PixelCounter& counter() { return counter_; }

 private:
  Easel(RenderTarget target, MeshRenderer renderer, PixelCounter counter)
      : target_(std::move(target)), renderer_(std::move(renderer)), counter_(std::move(counter)) {}

  RenderTarget target_;
  MeshRenderer renderer_;
  PixelCounter counter_;
};

// One mesh on the easel, seen by one camera. Easel and mesh must outlive it; another canvas of the
// same easel may be used in between.
class Canvas {
 public:
  Canvas(Easel& easel, SelectivelyRefinedMesh& mesh, const Quantization& quantization,
         const EvaluationView& view);

  // Of the mesh as it is now.
  Result<Picture> draw();
  // By vertex slot, of the mesh as it is now. Valid until the next call.
  Result<std::span<const uint32_t>> count();
  [[nodiscard]] const EvaluationView& view() const { return *view_; }
  [[nodiscard]] const Easel& easel() const { return *easel_; }

 private:
  Result<void> upload();

  Easel* easel_;
  SelectivelyRefinedMesh* mesh_;
  const EvaluationView* view_;
  GpuMesh gpuMesh_;
  std::vector<uint32_t> counts_;
};

// min(PSNR, kIdenticalPicturesPsnr).
[[nodiscard]] Result<double> psnrOf(const Picture& picture, const Picture& reference);

}  // namespace meshfront::evaluation
