// A client's mesh that is drawn: our receiver without the network, its records at hand.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "shared/refinement/front_budget.h"
#include "tests/evaluation/sender_experiments/measured_mesh.h"
#include "viewer/gl/gl_context.h"
#include "viewer/gl/gpu_mesh.h"
#include "viewer/gl/mesh_renderer.h"
#include "viewer/gl/pixel_counter.h"
#include "viewer/gl/render_target.h"
#include "viewer/picture/picture.h"

namespace meshfront::evaluation {

// What drawing needs, made once.
struct DrawingTools {
  GlContext context;
  MeshRenderer renderer;
  RenderTarget target;
  PixelCounter counter;
  [[nodiscard]] static Result<DrawingTools> create();
};

class DrawnClient {
 public:
  [[nodiscard]] static Result<DrawnClient> create(const MeasuredMesh& mesh, DrawingTools& tools);

  [[nodiscard]] SelectivelyRefinedMesh& mesh() { return *mesh_; }
  // Pixels by vertex slot of the mesh as it is; valid until the next call.
  Result<std::span<const uint32_t>> count(const Camera& camera);
  Result<Picture> draw(const Camera& camera);

  struct Refined {
    uint64_t records = 0;  // new ones
    uint64_t splits = 0;   // from those kept
    uint64_t collapses = 0;
    double seconds = 0;  // of refining: ranking, collapsing, splitting
  };
  // Truly selectively: what pixels ask for is split, and what no pixel asks for any more is
  // collapsed. Until the view is settled or the pixels have been counted so many times.
  Result<Refined> refine(const Camera& camera, unsigned rounds);
  // The time of one picture of the mesh as it is, seconds, the wait for it included.
  Result<double> timeDrawing(const Camera& camera);

  // One request of our receiver: the next records by significance and pixels. Octets of the answer
  // and, in `up`, of the set are returned; 0 when the view is settled.
  Result<uint64_t> fetch(const Camera& camera, uint64_t& up);

 private:
  DrawnClient(const MeasuredMesh& source, DrawingTools& tools, SelectivelyRefinedMesh mesh);
  Result<void> upload();
  Result<void> split(NodeIndex node);

  const MeasuredMesh* source_;
  DrawingTools* tools_;
  std::unique_ptr<SelectivelyRefinedMesh> mesh_;  // the budget keeps its address
  GpuMesh gpuMesh_;
  FrontBudget budget_;
  std::vector<uint32_t> pixels_;
  uint64_t views_ = 0;
};

}  // namespace meshfront::evaluation
