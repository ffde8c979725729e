// Balls around the vertices whose subtrees are not here yet, seen as circles over the picture: how
// far what is still missing may lie from what is shown.
//
// A vertex gets one if it is no leaf, covers pixels and its circle is large enough to be told from
// a dot. Compute shaders choose them on the GPU: the largest first, in steps of two, up to a
// number.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "shared/camera/bounds.h"
#include "shared/camera/camera.h"
#include "shared/result.h"
#include "viewer/gl/gl_object.h"
#include "viewer/gl/mesh_instance.h"
#include "viewer/gl/pixel_buffers.h"
#include "viewer/gl/render_target.h"

namespace meshfront {

// By significance level, in the mesh's own units.
using LevelRadii = std::array<float, 256>;

class MissingBounds {
 public:
  static constexpr uint32_t kMost = 16'384;       // circles of an instance
  static constexpr float kSmallestRadius = 2.5F;  // pixels

  [[nodiscard]] static Result<MissingBounds> create();

  // Onto the colours of a target that shows these instances; its items and depth stay. `radii`: one
  // table an instance; those without one, and those beyond the driver's storage blocks, are left
  // out. `pixels`: their counts. `finestLevel` as in DrawStyle, for the circles' colours, which are
  // missingColour()'s. `aspect` of the picture, 0: the target's own.
  void draw(RenderTarget& target, std::span<const MeshInstance> instances,
            std::span<const LevelRadii> radii, PixelBuffers& pixels, const Camera& camera,
            const Bounds& bounds, unsigned finestLevel, double aspect = 0) const;

 private:
  MissingBounds() = default;
  void choose(const MeshInstance& instance, const LevelRadii& radii, GlName pixels,
              const Projection& projection, PixelSize size) const;

  GlProgram measure_;  // how many circles there are of which size
  GlProgram choose_;   // those that fit
  GlProgram draw_;
  GlBuffer radii_;
  GlBuffer sizes_;
  GlBuffer circles_;
  GlBuffer command_;
  GlVertexArray vertexArray_;
};

}  // namespace meshfront
