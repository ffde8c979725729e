#include "shared/scene/view_lift.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

namespace meshfront {
namespace {

// 1 up to `inner`, 0 from `outer`, smooth in between.
double fallOff(double distance, double inner, double outer) {
  if (distance <= inner) return 1;
  if (distance >= outer) return 0;
  const double t = (outer - distance) / (outer - inner);
  return t * t * (3 - 2 * t);
}

}  // namespace

void liftOf(std::span<const GridPosition> positions, std::span<const uint32_t> pixels,
            const Quantization& quantization, const glm::dmat4& worldFromMesh, const Camera& camera,
            const Foveation& foveation, const std::optional<RefinedSpot>& spot,
            std::vector<uint8_t>& lift) {
  lift.clear();
  if (!foveation.on && !spot) return;
  const size_t count = std::min(positions.size(), pixels.size());
  lift.assign(count, 0);
  const ViewAxes axes = viewAxes(camera);
  const double halfHeight = std::tan(camera.verticalFov / 2);
  for (size_t slot = 0; slot < count; ++slot) {
    if (pixels[slot] == 0) continue;
    const auto at = quantization.toWorld(positions[slot]);
    const glm::dvec3 world(worldFromMesh * glm::dvec4(at[0], at[1], at[2], 1));
    double levels = 0;
    if (foveation.on) {
      const glm::dvec3 fromEye = world - camera.eye;
      const double depth = glm::dot(fromEye, axes.forward);
      if (depth > 0) {
        const glm::dvec2 place(glm::dot(fromEye, axes.right), glm::dot(fromEye, axes.upward));
        const double fromMiddle = glm::length(place) / (depth * halfHeight);
        levels = foveation.levels * fallOff(fromMiddle, foveation.inner, foveation.outer);
      }
    }
    if (spot) {
      const double distance = glm::distance(world, spot->centre);
      levels = std::max(levels, kSpotLift * fallOff(distance, 0, spot->radius));
    }
    lift[slot] = static_cast<uint8_t>(std::lround(levels));
  }
}

}  // namespace meshfront
