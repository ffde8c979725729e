#include "viewer/gl/picking.h"

#include <glm/geometric.hpp>
#include <limits>

namespace meshfront {

std::optional<Picked> pick(const RenderTarget& target, std::span<const MeshInstance> instances,
                           const Camera& camera, const Bounds& bounds, int x, int y,
                           double aspect) {
  const std::optional<SceneFace> seen = faceOfItem(instances, target.itemAt(x, y));
  const double depth = seen ? target.depthAt(x, y) : 0;
  if (!seen || !(depth > 0)) return std::nullopt;
  const MeshInstance& instance = instances[seen->instance];
  Picked picked;
  picked.instance = seen->instance;
  picked.face = seen->face;
  picked.slots = instance.mesh->corners()[seen->face];
  const PixelSize size = target.size();
  const Projection projection =
      Projection::fit(camera, bounds, aspect > 0 ? aspect : size.aspect());
  picked.world = projection.worldPoint(
      {2 * (x + 0.5) / size.width - 1, 1 - 2 * (y + 0.5) / size.height}, depth);
  double shortest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < 3; ++i) {
    const DrawnVertex vertex = instance.mesh->vertexAt(picked.slots.at(i));
    const std::array<double, 3> own = instance.mesh->quantization().toWorld(vertex.position);
    const glm::dvec3 place(instance.worldFromMesh * glm::dvec4(own[0], own[1], own[2], 1));
    const double distance = glm::length(place - picked.world);
    if (distance >= shortest) continue;
    shortest = distance;
    picked.nearest = i;
    picked.vertex = vertex;
  }
  return picked;
}

}  // namespace meshfront
