// A pass that only ranks: the items of a scene as a camera sees it, drawn into a target of their
// own and counted, at the picture's resolution or a lower one. Where the picture itself was drawn
// at full resolution, its target holds the same items and PixelCounter::start() on it is enough.
#pragma once

#include <cstdint>
#include <span>

#include "shared/camera/bounds.h"
#include "shared/camera/camera.h"
#include "shared/result.h"
#include "viewer/gl/mesh_instance.h"
#include "viewer/gl/mesh_renderer.h"
#include "viewer/gl/pixel_counter.h"
#include "viewer/gl/render_target.h"

namespace meshfront {

struct RankingView {
  Camera camera;
  Bounds bounds;   // of the whole scene
  PixelSize size;  // of the picture
  // 1, 2 or 4: one item stands for so many pixels each way, and counts are multiplied by its
  // square. Vertices whose triangles are all smaller than that may count nothing.
  int divisor = 1;
  DrawStyle style;  // as the picture is drawn
  FrameState frame;
};

class RankingPass {
 public:
  [[nodiscard]] static Result<RankingPass> create(PixelCounter::Method method);

  // Draws and starts counting; never waits for a GPU. False, and nothing is drawn, while too many
  // counts are under way. Errors: a size that cannot be drawn, a divisor that is none.
  Result<bool> start(const MeshRenderer& renderer, std::span<const MeshInstance> instances,
                     const RankingView& view, uint64_t tag = 0);
  // The latest counts that have arrived, as PixelCounter::take().
  bool take(PixelCounts& into) { return counter_.take(into); }

  [[nodiscard]] const PixelCounter& counter() const { return counter_; }
  [[nodiscard]] const RenderTarget& target() const { return target_; }

 private:
  RankingPass(RenderTarget target, PixelCounter counter)
      : target_(std::move(target)), counter_(std::move(counter)) {}

  RenderTarget target_;
  PixelCounter counter_;
};

}  // namespace meshfront
