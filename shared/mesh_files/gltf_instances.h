// Which meshes a glTF document shows, and where: the scene's nodes with their transforms composed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/mesh_files/gltf_model.h"
#include "shared/result.h"

namespace meshfront {

struct GltfInstance {
  uint32_t mesh = 0;
  uint32_t node = 0;
  GltfTransform toWorld{};
};

// The nodes with meshes of the default scene; without one, of all scenes; without scenes, of all
// nodes. In the order of the document, parents first. A node with a skin stands where its mesh is
// stored, as the specification has it. Errors: a node with two parents or below itself.
[[nodiscard]] Result<std::vector<GltfInstance>> shownMeshes(const GltfModel& model);

[[nodiscard]] std::array<double, 3> transformed(const GltfTransform& t,
                                                const std::array<double, 3>& point);
// Below 0 if the transform mirrors.
[[nodiscard]] double determinant(const GltfTransform& t);
// The direction that stays perpendicular, of length 1, or 0 where nothing is left of it.
[[nodiscard]] std::array<double, 3> transformedNormal(const GltfTransform& t,
                                                      const std::array<double, 3>& normal);

}  // namespace meshfront
