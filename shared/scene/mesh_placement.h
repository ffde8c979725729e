// Where a mesh stands in a scene: what it takes to compare meshes of different sizes at different
// distances, and to put their bounds together.
#pragma once

#include <glm/mat4x4.hpp>

#include "shared/camera/bounds.h"
#include "shared/camera/camera.h"

namespace meshfront {

// The box around a box that `worldFromMesh` (affine) has moved.
[[nodiscard]] Bounds movedBounds(const Bounds& bounds, const glm::dmat4& worldFromMesh);
[[nodiscard]] Bounds unitedBounds(const Bounds& a, const Bounds& b);

// How large a mesh looks: the radius of its bounds over the distance from the eye to their nearest
// point, at most kLargestApparentSize (the eye is close to it or within).
inline constexpr double kLargestApparentSize = 16;
[[nodiscard]] double apparentSize(const Bounds& world, const glm::dvec3& eye);

// A significance level is the octave of the mesh's vertex count (codec/code_tables.h), so that an
// edge at level l is about apparentSize * 2^(-l/2) long as it is seen. By how many levels later a
// mesh comes that looks smaller than the one that looks largest: 0 .. kMostLevelsBehind.
inline constexpr unsigned kMostLevelsBehind = 24;
[[nodiscard]] unsigned levelsBehind(double apparentSize, double largestApparentSize);

}  // namespace meshfront
