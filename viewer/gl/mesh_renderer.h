// Draws a mesh into a RenderTarget: clay or its own colours under a head
// light, both sides, smooth or flat, with or
// without its edges. The colour of a vertex's surroundings depends on the triangles alone, not on
// their order: a streamed mesh that is complete gives the reference mesh's picture.
//
//   auto renderer = MeshRenderer::create();
//   auto target = RenderTarget::create({500, 500});
//   renderer->draw(*target, gpuMesh, camera, bounds, {});
//   writePng(target->readPicture(), "mesh.png");
#pragma once

#include <array>
#include <optional>

#include "shared/camera/bounds.h"
#include "shared/camera/camera.h"
#include "shared/result.h"
#include "viewer/gl/gl_object.h"
#include "viewer/gl/gpu_mesh.h"
#include "viewer/gl/render_target.h"

namespace meshfront {

struct DrawStyle {
  bool flatShading = false;
  bool colours = true;     // the mesh's own where it has any, else clay
  bool wireframe = false;  // left out of meshes beyond the driver's storage blocks (128 MB or more)
  std::array<float, 3> background = {0.90F, 0.905F, 0.915F};  // sRGB, 0 .. 1

  bool operator==(const DrawStyle&) const = default;
};

class MeshRenderer {
 public:
  [[nodiscard]] static Result<MeshRenderer> create();

  // Colour, depth and items. `bounds` are of the whole mesh and fit the clipping planes.
  void draw(RenderTarget& target, const GpuMesh& mesh, const Camera& camera, const Bounds& bounds,
            const DrawStyle& style) const;
  // Depth and items only, the same items as draw() makes; the target's colours stay.
  void drawItems(RenderTarget& target, const GpuMesh& mesh, const Camera& camera,
                 const Bounds& bounds) const;

 private:
  struct Program {
    GlProgram program;
    int anchor = -1;  // uniform locations
    int clipFromGrid = -1;
    int viewFromGrid = -1;
    int flatShading = -1;
    int colours = -1;
    int halfPicture = -1;
    explicit Program(GlProgram linked);
  };
  MeshRenderer(Program shaded, Program wireframe, Program items);
  static void drawWith(const Program& program, const RenderTarget& target, const GpuMesh& mesh,
                       const Projection& projection);

  Program shaded_;
  Program wireframe_;
  Program items_;
};

}  // namespace meshfront
