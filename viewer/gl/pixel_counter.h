// Visual importance of a vertex: how many pixels its incident visible triangles cover (Cheng and
// Ooi 2008, section 4.2). Each pixel of the item buffer counts once for each of the three corners
// of its triangle, so that the counts add up to three times the covered pixels.
//
//   renderer.drawItems(target, gpuMesh, camera, bounds);
//   counter.count(target, gpuMesh, counts);   // counts[vertexSlot]
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/mesh/indexed_mesh.h"
#include "shared/result.h"
#include "viewer/gl/gl_context.h"
#include "viewer/gl/gl_object.h"
#include "viewer/gl/gpu_mesh.h"
#include "viewer/gl/render_target.h"

namespace meshfront {

class PixelCounter {
 public:
  enum class Method {
    compute,   // on the GPU
    readBack,  // the item buffer comes to the CPU: the reference, and the way without compute
  };

  // Compute on a GPU; where the CPU draws, the items lie in its memory already and reading them
  // back is several times faster.
  [[nodiscard]] static Method preferred(const GlContext& context);
  // Falls back to reading back when the compute shader cannot be built.
  [[nodiscard]] static PixelCounter create(Method wanted = Method::compute);

  [[nodiscard]] Method method() const { return method_; }
  // Why the wanted method is not used; empty when it is.
  [[nodiscard]] const std::string& fallbackReason() const { return fallbackReason_; }

  // Counts what was last drawn into the target, which must have been this mesh as it is now on the
  // GPU. `counts` gets one number a vertex slot; its storage is reused.
  void count(const RenderTarget& target, const GpuMesh& mesh, std::vector<uint32_t>& counts);

 private:
  explicit PixelCounter(Method method) : method_(method) {}
  void countOnGpu(const RenderTarget& target, const GpuMesh& mesh, std::vector<uint32_t>& counts);

  Method method_;
  std::string fallbackReason_;
  GlProgram program_;
  GlBuffer counts_;
  size_t capacity_ = 0;  // bytes
  std::vector<uint32_t> items_;
};

// The reference: `items` as RenderTarget::readItems gives them, `counts` set to `vertexCount`
// numbers. Items that name no triangle are ignored.
void countPixels(std::span<const uint32_t> items, std::span<const Triangle> corners,
                 size_t vertexCount, std::vector<uint32_t>& counts);

}  // namespace meshfront
