// Visual importance of a vertex: how many pixels its incident visible triangles cover (Cheng and
// Ooi 2008, section 4.2). Each pixel of the item buffer counts once for each of the three corners
// of its triangle, so that the counts add up to three times the covered pixels.
//
//   renderer.drawItems(target, instances, camera, bounds);
//   counter.start(target, instances, frame);          // never waits
//   ...
//   if (counter.take(counted)) rank(counted.pixels);  // of this or an earlier frame
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/mesh/indexed_mesh.h"
#include "shared/result.h"
#include "viewer/gl/gl_context.h"
#include "viewer/gl/gl_object.h"
#include "viewer/gl/gpu_mesh.h"
#include "viewer/gl/mesh_instance.h"
#include "viewer/gl/pass_timer.h"
#include "viewer/gl/render_target.h"

namespace meshfront {

struct PixelCounts {
  std::vector<std::vector<uint32_t>> pixels;          // [instance][vertex slot]
  std::vector<std::optional<uint64_t>> changeCounts;  // of each instance's mesh as it was counted
  uint64_t tag = 0;                                   // as given to start()
};

class PixelCounter {
 public:
  enum class Method {
    compute,   // on the GPU
    readBack,  // the item buffer comes to the CPU: the reference, and the way without compute
  };
  // Counts that may be under way at a time.
  static constexpr size_t kMostUnderWay = 3;

  // Compute on a GPU; where the CPU draws, the items lie in its memory already and reading them
  // back is several times faster.
  [[nodiscard]] static Method preferred(const GlContext& context);
  // Falls back to reading back when the compute shader cannot be built.
  [[nodiscard]] static PixelCounter create(Method wanted = Method::compute);

  [[nodiscard]] Method method() const { return method_; }
  // Why the wanted method is not used; empty when it is.
  [[nodiscard]] const std::string& fallbackReason() const { return fallbackReason_; }

  // Counts what was last drawn into the target, which must have been these instances as their
  // meshes are now on the GPU, and waits for it. Storage is reused.
  void count(const RenderTarget& target, std::span<const MeshInstance> instances,
             std::vector<std::vector<uint32_t>>& counts);
  // The same of a mesh alone.
  void count(const RenderTarget& target, const GpuMesh& mesh, std::vector<uint32_t>& counts);

  // Starts counting the same; the target and the meshes may change at once afterwards. False, and
  // nothing is started, while kMostUnderWay counts have not arrived. `times` multiplies the counts:
  // the pixels of the picture that one of the target stands for.
  // Never waits for a GPU with Method::compute; with readBack it is all done here.
  bool start(const RenderTarget& target, std::span<const MeshInstance> instances, uint64_t tag = 0,
             uint32_t times = 1);
  // The latest counts that have arrived since the last call; those before it are dropped. Never
  // waits. False, and `into` untouched, where there are none.
  bool take(PixelCounts& into);
  // Counts started and neither taken nor dropped.
  [[nodiscard]] size_t underWay() const { return started_.size(); }

  // On the GPU (with readBack: what the GL had to do for it), the last one known.
  [[nodiscard]] std::optional<double> milliseconds() { return timer_.milliseconds(); }
  // On the GPU.
  [[nodiscard]] size_t byteCount() const;

 private:
  // A buffer in which counts come back; mapped for as long as it lives.
  struct ReadBack {
    GlBuffer buffer;
    const uint32_t* mapped = nullptr;
    size_t capacity = 0;  // counts
  };
  struct Started {
    PixelCounts counts;  // `pixels` sized; filled when they arrive, at once with readBack
    ReadBack from;
    GlSync arrived;
    uint32_t times = 1;
  };
  explicit PixelCounter(Method method) : method_(method) {}
  [[nodiscard]] bool canCompute(std::span<const MeshInstance> instances) const;
  // Leaves all instances' counts, one after the other, in counts_; false without GPU memory.
  bool computeCounts(const RenderTarget& target, std::span<const MeshInstance> instances,
                     size_t total);
  bool readBackInto(ReadBack& from, size_t total);
  [[nodiscard]] bool hasArrived(Started& started) const;

  Method method_;
  std::string fallbackReason_;
  GlProgram program_;
  GlBuffer counts_;
  size_t capacity_ = 0;  // counts
  std::deque<Started> started_;
  std::vector<ReadBack> spare_;
  std::vector<uint32_t> items_;
  PassTimer timer_;
};

// The reference: `items` as RenderTarget::readItems gives them, `counts` set to `vertexCount`
// numbers. Items that name no triangle are ignored.
void countPixels(std::span<const uint32_t> items, std::span<const Triangle> corners,
                 size_t vertexCount, std::vector<uint32_t>& counts);
// The same over the instances of a scene: [instance][vertex slot].
void countPixels(std::span<const uint32_t> items, std::span<const MeshInstance> instances,
                 std::vector<std::vector<uint32_t>>& counts);

}  // namespace meshfront
