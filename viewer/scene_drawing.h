// A scene on the GPU: takes what the refinement tells of its meshes, draws them, and counts what
// each front vertex covers. The same in a window and without one.
//
//   drawing.take(thread.takeNews(), seconds);
//   drawing.draw(target, camera, bounds, style, seconds);
//   drawing.startCount(target, camera);
//   if (auto counts = drawing.takeCounts()) thread.see(std::move(*counts));
//
// Needs a current GL context, which must outlive it.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/camera/bounds.h"
#include "shared/camera/camera.h"
#include "shared/result.h"
#include "shared/scene/mesh_news.h"
#include "shared/scene/scene_counts.h"
#include "shared/scene/scene_file.h"
#include "viewer/gl/gpu_mesh.h"
#include "viewer/gl/mesh_instance.h"
#include "viewer/gl/mesh_renderer.h"
#include "viewer/gl/missing_bounds.h"
#include "viewer/gl/picking.h"
#include "viewer/gl/pixel_buffers.h"
#include "viewer/gl/pixel_counter.h"
#include "viewer/gl/ranking_pass.h"
#include "viewer/gl/render_target.h"

namespace meshfront {

class SceneDrawing {
 public:
  // Bytes that one take() uploads, about: what a frame has time for.
  static constexpr size_t kUploadAtATime = size_t{8} << 20;

  [[nodiscard]] static Result<SceneDrawing> create(std::span<const SceneMesh> meshes,
                                                   PixelCounter::Method countingMethod);

  // Takes news over and uploads some of what has been taken. `seconds` on a clock that does not go
  // back. True when the picture would differ.
  Result<bool> take(std::vector<MeshNews> news, double seconds, size_t byteLimit = kUploadAtATime);
  [[nodiscard]] bool isUploading() const;

  // World; of the meshes that are here; nullopt before the first.
  [[nodiscard]] const std::optional<Bounds>& bounds() const { return bounds_; }
  [[nodiscard]] bool hasColours() const;
  // Until when vertices slide, on the clock of take().
  [[nodiscard]] double slidesUntil(double slideSeconds) const;

  // Colour, depth and items. `style.finestLevel` is filled in. `missing`: circles around the
  // vertices that may still be split.
  void draw(RenderTarget& target, const Camera& camera, const Bounds& bounds, DrawStyle style,
            bool missing, double seconds);

  // Draws the items and counts them, waiting for it.
  [[nodiscard]] SceneCounts countNow(RenderTarget& target, const Camera& camera,
                                     const Bounds& bounds, DrawStyle style);
  // Counts what draw() has just drawn. False while too many counts are under way.
  bool startCount(const RenderTarget& target, const Camera& camera);
  // The latest counts that have arrived.
  [[nodiscard]] std::optional<SceneCounts> takeCounts();
  // Draws the items alone, for another view or at a lower resolution (RankingView::divisor), and
  // starts counting them. `style` as the picture is drawn; `ahead`: of a view that may come.
  Result<bool> startPass(const Camera& camera, const Bounds& bounds, PixelSize picture, int divisor,
                         const DrawStyle& style, double seconds, bool ahead);
  [[nodiscard]] std::optional<SceneCounts> takePass();
  // Counts are under way.
  [[nodiscard]] bool isCounting() const {
    return counter_.underWay() > 0 || pass_.counter().underWay() > 0;
  }
  // What the last count of a whole picture took: on the GPU, or here where it is done here; 0
  // before the first.
  [[nodiscard]] double countSeconds() {
    return counter_.method() == PixelCounter::Method::readBack
               ? countSeconds_
               : counter_.milliseconds().value_or(0) / 1000;
  }

  // What a pixel of the target that draw() was given shows; nothing for the background.
  struct Place {
    size_t mesh = 0;     // of the scene
    uint32_t slot = 0;   // of the corner nearest to the point
    DrawnVertex vertex;  // that corner
  };
  [[nodiscard]] std::optional<Place> placeAt(const RenderTarget& target, const Camera& camera,
                                             const Bounds& bounds, int x, int y) const;
  [[nodiscard]] const MeshRenderer& renderer() const { return renderer_; }
  [[nodiscard]] unsigned finestLevel() const { return finestLevel_; }
  [[nodiscard]] const MeshMetadata& metadata(size_t mesh) const { return *meshes_[mesh].metadata; }

 private:
  struct Drawn {
    glm::dmat4 worldFromMesh{1.0};
    std::optional<MeshMetadata> metadata;
    std::unique_ptr<GpuMesh> mesh;  // null until there is one
    bool taken = false;             // in this take()
  };
  SceneDrawing(MeshRenderer renderer, PixelCounter counter, MissingBounds missing,
               RankingPass pass);
  void introduce(MeshNews& news);
  [[nodiscard]] SceneCounts countsOf(const PixelCounts& counted) const;

  MeshRenderer renderer_;
  PixelCounter counter_;
  MissingBounds missing_;
  RankingPass pass_;
  PixelBuffers shownCounts_;
  std::vector<Drawn> meshes_;            // by mesh of the scene
  std::vector<MeshInstance> instances_;  // of those that are here
  std::vector<size_t> meshOfInstance_;
  std::optional<Bounds> bounds_;
  unsigned finestLevel_ = 0;
  std::vector<LevelRadii> radii_;  // by instance
  struct CountedView {
    uint64_t tag = 0;
    Camera camera;
    PixelSize picture;
    size_t instances = 0;
    bool ahead = false;
  };
  // Of counts under way, oldest first.
  class CountedViews {
   public:
    uint64_t add(const Camera& camera, PixelSize picture, size_t instances, bool ahead);
    void dropLast() { views_.pop_back(); }
    // Of the counts with this tag; those before are forgotten.
    [[nodiscard]] std::optional<CountedView> take(uint64_t tag);

   private:
    std::deque<CountedView> views_;
    uint64_t next_ = 0;
  };
  CountedViews views_;
  CountedViews passViews_;
  double countSeconds_ = 0;  // of the last count, here
  PixelCounts taken_;        // reused
};

}  // namespace meshfront
