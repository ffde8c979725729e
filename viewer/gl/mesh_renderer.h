// Draws the meshes of a scene into a RenderTarget: clay, their own colours or a scale under a head
// light, both sides, smooth or flat, with or without their edges. The colour of a vertex's
// surroundings depends on the triangles alone, not on their order: a streamed mesh that is complete
// gives the reference mesh's picture.
//
//   auto renderer = MeshRenderer::create();
//   auto target = RenderTarget::create({500, 500});
//   renderer->draw(*target, std::array{MeshInstance{&gpuMesh}}, camera, bounds, {});
//   writePng(target->readPicture(), "mesh.png");
//
// Colours with alpha are drawn as a screen door: that share of the surface's pixels, in an ordered
// pattern. No sorting is needed, every pixel still shows one triangle, and the items are exact.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>

#include "shared/camera/bounds.h"
#include "shared/camera/camera.h"
#include "shared/result.h"
#include "viewer/gl/gpu_mesh.h"
#include "viewer/gl/mesh_instance.h"
#include "viewer/gl/mesh_programs.h"
#include "viewer/gl/pixel_buffers.h"
#include "viewer/gl/render_target.h"

namespace meshfront {

// What the surface's colour says; the colours are colour_scales.h's.
enum class Colouring {
  surface,  // clay or its own
  tree,     // of the vertex hierarchy
  level,    // significance
  pixels,   // counted by vertex, as FrameState::pixels holds them
  missing,  // final, or how coarse it still is
};

// How long a split slides where it does, seconds.
inline constexpr float kDefaultSlide = 0.15F;

struct DrawStyle {
  bool flatShading = false;
  bool colours = true;     // the mesh's own where it has any, else clay
  bool wireframe = false;  // left out of meshes beyond the driver's storage blocks (128 MB or more)
  std::array<float, 3> background = {0.90F, 0.905F, 0.915F};  // sRGB, 0 .. 1
  Colouring colouring = Colouring::surface;
  unsigned finestLevel = 31;  // of the meshes, for the scales of level and missing
  float slideSeconds = 0;     // 0: new vertices stand where they belong at once

  bool operator==(const DrawStyle&) const = default;
};

// What else a picture depends on.
struct FrameState {
  double now = 0;                  // on the clock given to GpuMesh::apply(), seconds
  PixelBuffers* pixels = nullptr;  // for Colouring::pixels; without any all count none
  double aspect = 0;               // width by height of what the target shows; 0: the target's own
};

class MeshRenderer {
 public:
  [[nodiscard]] static Result<MeshRenderer> create();

  // Colour, depth and items. `bounds` are of the whole scene and fit the clipping planes. Instances
  // that cannot be in the picture are left out.
  void draw(RenderTarget& target, std::span<const MeshInstance> instances, const Camera& camera,
            const Bounds& bounds, const DrawStyle& style, const FrameState& frame = {}) const;
  // Depth and items only, the same items as draw() makes with that style; the target's colours
  // stay.
  void drawItems(RenderTarget& target, std::span<const MeshInstance> instances,
                 const Camera& camera, const Bounds& bounds, const DrawStyle& style = {},
                 const FrameState& frame = {}) const;
  // A mesh alone, where its own coordinates put it.
  void draw(RenderTarget& target, const GpuMesh& mesh, const Camera& camera, const Bounds& bounds,
            const DrawStyle& style) const {
    draw(target, std::array{MeshInstance{&mesh}}, camera, bounds, style);
  }
  void drawItems(RenderTarget& target, const GpuMesh& mesh, const Camera& camera,
                 const Bounds& bounds) const {
    drawItems(target, std::array{MeshInstance{&mesh}}, camera, bounds);
  }

  // Why a style is drawn plainer than asked for (a driver that cannot build its shader), or empty.
  [[nodiscard]] const std::string& problem() const { return programs_->problem(); }

 private:
  struct Pass;
  explicit MeshRenderer(MeshPrograms programs)
      : programs_(std::make_unique<MeshPrograms>(std::move(programs))) {}
  void drawAll(const RenderTarget& target, std::span<const MeshInstance> instances,
               const Pass& pass) const;
  void drawOne(const MeshInstance& instance, size_t number, uint32_t firstItem,
               const Pass& pass) const;

  std::unique_ptr<MeshPrograms> programs_;  // grows while drawing
};

}  // namespace meshfront
