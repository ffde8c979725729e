// What is likely to be wrong in the picture around a front vertex, as far as the mesh tells that is
// there: a surface that is bent at this scale is likely bent at the next one. Inside, the normals
// of the triangles at the vertex differ, and so will the shades of what is missing, over the pixels
// that they cover. On the silhouette, and at a boundary, the pixels between an edge and the arc
// that it stands for are wrong, and much more so, since what is behind has another colour.
//
// A ranking by it and the significance level needs a tenth to two fifths fewer records to 40 dB
// than one by level and pixels (tests/evaluation/quality).
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "shared/refinement/selectively_refined_mesh.h"

namespace meshfront {

// Its logarithm is told in levels by which a vertex comes earlier: 0 .. kMostErrorLift.
inline constexpr uint8_t kMostErrorLift = 32;

// Adds to the lift of each vertex that covers a pixel and can be split. `eye`: in grid steps of the
// mesh, need not be whole. `pixelsAtOne`: of a length seen from as far away as it is long. `pixels`
// by vertex slot; `lift` likewise, or empty for none so far.
void liftByLikelyError(const SelectivelyRefinedMesh& mesh, std::span<const uint32_t> pixels,
                       const glm::dvec3& eye, double pixelsAtOne, std::vector<uint8_t>& lift);

}  // namespace meshfront
