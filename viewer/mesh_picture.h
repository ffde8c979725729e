// Draws a front from a camera and counts what it covers: everything that a viewer, with a window or
// without, needs of GL.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "shared/camera/bounds.h"
#include "shared/camera/camera.h"
#include "shared/refinement/selectively_refined_mesh.h"
#include "shared/result.h"
#include "viewer/gl/gpu_mesh.h"
#include "viewer/gl/mesh_renderer.h"
#include "viewer/gl/pixel_counter.h"
#include "viewer/gl/render_target.h"
#include "viewer/picture/picture.h"

namespace meshfront {

class MeshPicture {
 public:
  // Needs a current GL context, which must outlive it. `quantization`: the mesh's grid.
  [[nodiscard]] static Result<MeshPicture> create(PixelSize size, const Quantization& quantization,
                                                  const Bounds& bounds,
                                                  PixelCounter::Method countingMethod);

  // Pixels by vertex slot of the mesh as it is now; valid until the next call.
  [[nodiscard]] Result<std::span<const uint32_t>> count(const SelectivelyRefinedMesh& mesh,
                                                        const Camera& camera);
  Result<void> draw(const SelectivelyRefinedMesh& mesh, const Camera& camera,
                    const DrawStyle& style);
  // Of the last draw().
  [[nodiscard]] Picture read() const { return target_.readPicture(); }
  // Draws another mesh the same way into the same target.
  [[nodiscard]] Result<Picture> drawOther(const MeshArrays& mesh, const Camera& camera,
                                          const DrawStyle& style);

  Result<void> resize(PixelSize size) { return target_.resize(size); }
  [[nodiscard]] const RenderTarget& target() const { return target_; }
  [[nodiscard]] const Bounds& bounds() const { return bounds_; }

 private:
  MeshPicture(RenderTarget target, MeshRenderer renderer, PixelCounter counter,
              const Quantization& quantization, const Bounds& bounds)
      : target_(std::move(target)),
        renderer_(std::move(renderer)),
        counter_(std::move(counter)),
        quantization_(quantization),
        bounds_(bounds) {}
  Result<void> upload(const SelectivelyRefinedMesh& mesh);

  RenderTarget target_;
  MeshRenderer renderer_;
  PixelCounter counter_;
  GpuMesh gpuMesh_;
  Quantization quantization_;
  Bounds bounds_;
  std::vector<uint32_t> counts_;
};

}  // namespace meshfront
