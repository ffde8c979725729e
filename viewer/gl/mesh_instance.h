// A scene as it is drawn: meshes that stand somewhere in the world. Items number the face slots of
// all instances in their order: item 0 is the background, and face slot f of instance i is item
// 1 + f + (face slots of the instances before i). The same mesh may stand in several places.
#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <optional>
#include <span>

#include "shared/camera/camera.h"
#include "viewer/gl/gpu_mesh.h"

namespace meshfront {

struct MeshInstance {
  const GpuMesh* mesh = nullptr;  // never null where an instance is given
  glm::dmat4 worldFromMesh{1.0};  // affine, finite, not singular; may mirror
};

struct SceneFace {
  size_t instance = 0;
  uint32_t face = 0;  // slot
  friend bool operator==(const SceneFace&, const SceneFace&) = default;
};
// Nothing for the background and for items beyond the last face.
[[nodiscard]] std::optional<SceneFace> faceOfItem(std::span<const MeshInstance> instances,
                                                  uint32_t item);
// All instances' face slots; a scene of more than 2^32 - 2 is drawn without what is beyond.
[[nodiscard]] uint64_t faceSlotsOf(std::span<const MeshInstance> instances);

// When every slide of these has come to its end, on the clock given to GpuMesh::apply(); until then
// a still view needs drawing again. `seconds`: how long one takes.
[[nodiscard]] double slidesUntil(std::span<const MeshInstance> instances, double seconds);

// How an instance's grid maps to the picture, relative to a grid point near the eye, which is
// subtracted as integers: nothing is lost close to the surface of a fine grid, nor in
// georeferenced coordinates.
struct InstanceView {
  GridPosition anchor{};
  glm::dmat4 clipFromGrid{1.0};  // from grid steps relative to the anchor
  glm::dmat4 viewFromGrid{1.0};
  glm::dmat3 viewFromNormal{1.0};  // of any length; turns with the winding where one is mirrored
  double worldStep = 1;            // a grid step's length in the world, the longest one

  [[nodiscard]] static InstanceView of(const MeshInstance& instance, const Projection& projection);
  // Whether any of the mesh's grid may lie in the picture.
  [[nodiscard]] bool mayBeSeen(const Quantization& quantization) const;
};

}  // namespace meshfront
