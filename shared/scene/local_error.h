// How far the surface around a front vertex may still be from what is shown.
#pragma once

#include <cmath>

#include "shared/camera/bounds.h"
#include "shared/store/mesh_metadata.h"

namespace meshfront {

// An estimate, in the mesh's units, for a vertex that is no leaf: half the length of an edge of a
// mesh of 2^level vertices spread evenly over the surface of the bounds. Records tell the octave of
// the vertex count (a significance level), not a distance. A leaf's error is 0.
[[nodiscard]] inline double localError(const MeshMetadata& metadata, unsigned level) {
  const glm::dvec3 size = Bounds::of(metadata.boundsMin, metadata.boundsMax).extent();
  const double area = 2 * (size.x * size.y + size.y * size.z + size.z * size.x);
  // Twice as many triangles as vertices; an equilateral one of side a has a^2 * sqrt(3) / 4.
  const double side = std::sqrt(area / std::exp2(level) / 2 * 4 / std::sqrt(3.0));
  return side / 2;
}

}  // namespace meshfront
