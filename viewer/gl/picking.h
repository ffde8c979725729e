// What lies under the cursor.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "shared/mesh/indexed_mesh.h"
#include "shared/refinement/mesh_update.h"
#include "viewer/gl/mesh_instance.h"
#include "viewer/gl/render_target.h"

namespace meshfront {

struct Picked {
  size_t instance = 0;
  uint32_t face = 0;   // slot
  Triangle slots{};    // its corners' vertex slots
  size_t nearest = 0;  // which of them is the nearest to the point
  DrawnVertex vertex;  // that one: its node, tree, level
  glm::dvec3 world{};  // the point, from the depth
};

// At a pixel counted from the upper left. The target shows these instances, and their meshes have
// not changed since. `bounds` and `camera` are those it was drawn with; `aspect` of the picture, 0:
// the target's own. Waits for the GPU. Nothing for the background.
[[nodiscard]] std::optional<Picked> pick(const RenderTarget& target,
                                         std::span<const MeshInstance> instances,
                                         const Camera& camera, const Bounds& bounds, int x, int y,
                                         double aspect = 0);

}  // namespace meshfront
