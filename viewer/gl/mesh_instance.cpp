#include "viewer/gl/mesh_instance.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

namespace meshfront {

std::optional<SceneFace> faceOfItem(std::span<const MeshInstance> instances, uint32_t item) {
  if (item == 0) return std::nullopt;
  uint64_t face = item - 1;
  for (size_t i = 0; i < instances.size(); ++i) {
    const size_t faces = instances[i].mesh->triangleCount();
    if (face < faces) return SceneFace{i, static_cast<uint32_t>(face)};
    face -= faces;
  }
  return std::nullopt;
}

uint64_t faceSlotsOf(std::span<const MeshInstance> instances) {
  uint64_t faces = 0;
  for (const MeshInstance& instance : instances) faces += instance.mesh->triangleCount();
  return faces;
}

double slidesUntil(std::span<const MeshInstance> instances, double seconds) {
  double until = -std::numeric_limits<double>::infinity();
  for (const MeshInstance& instance : instances)
    until = std::max(until, instance.mesh->lastBirth() + seconds);
  return until;
}

InstanceView InstanceView::of(const MeshInstance& instance, const Projection& projection) {
  const Quantization& quantization = instance.mesh->quantization();
  const glm::dvec3 eye =
      glm::dvec3(glm::inverse(instance.worldFromMesh) * glm::dvec4(projection.camera.eye, 1));
  InstanceView view;
  view.anchor = quantization.toGrid({eye.x, eye.y, eye.z});
  const std::array<double, 3> point = quantization.toWorld(view.anchor);
  const glm::dvec3 origin(instance.worldFromMesh * glm::dvec4(point[0], point[1], point[2], 1));
  const glm::dmat3 linear = glm::dmat3(instance.worldFromMesh) * quantization.step;
  view.clipFromGrid = projection.clipFrom(origin) * glm::dmat4(linear);
  view.viewFromGrid = projection.viewFrom(origin) * glm::dmat4(linear);
  // Cofactors: cross products map by them, which is what a normal is.
  const glm::dmat3 m(view.viewFromGrid);
  view.viewFromNormal = {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
  double longest = 0;
  view.worldStep = 0;
  for (int i = 0; i < 3; ++i) {
    longest = std::max(longest, glm::length(view.viewFromNormal[i]));
    view.worldStep = std::max(view.worldStep, glm::length(linear[i]));
  }
  // Near one, as floats have it easy there.
  if (longest > 0) view.viewFromNormal = view.viewFromNormal / longest;
  return view;
}

bool InstanceView::mayBeSeen(const Quantization& quantization) const {
  // All corners of the grid beyond one plane of the picture: -x, x, -y, y, far, near.
  unsigned beyond = 0b111111;
  for (unsigned corner = 0; corner < 8; ++corner) {
    glm::dvec4 p(0, 0, 0, 1);
    for (int axis = 0; axis < 3; ++axis) {
      const bool high = ((corner >> axis) & 1U) != 0;
      p[axis] = (high ? quantization.maximum() : 0) - anchor.at(static_cast<size_t>(axis));
    }
    const glm::dvec4 c = clipFromGrid * p;
    beyond &= (c.x < -c.w ? 1U : 0U) | (c.x > c.w ? 2U : 0U) | (c.y < -c.w ? 4U : 0U) |
              (c.y > c.w ? 8U : 0U) | (c.z < 0 ? 16U : 0U) | (c.z > c.w ? 32U : 0U);
  }
  return beyond == 0;
}

}  // namespace meshfront
