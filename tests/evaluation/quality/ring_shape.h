// What the triangles around a front vertex tell of how it is seen, and of how much is likely to be
// missing there: a surface that is bent at this scale is likely bent at the next one.
#pragma once

#include "shared/camera/camera.h"
#include "shared/mesh/quantization.h"
#include "shared/refinement/selectively_refined_mesh.h"

namespace meshfront::evaluation {

struct RingShape {
  double area = 0;            // of the triangles, grid steps^2
  double normalVariance = 0;  // 0 .. 1: area-weighted, of their unit normals
  double edgeLength = 0;      // mean of the edges at the vertex, grid steps
  // Of the edges at the vertex between a triangle that faces the eye and one that does not, their
  // length in the picture, pixels.
  double silhouettePixels = 0;
  double pixelsAStep = 0;  // at the vertex' distance
  double facing = 0;       // cosine between the mean normal and the way to the eye
};

// `eye`: in grid steps. `pixelsAtOne`: of a length seen from as far away.
[[nodiscard]] RingShape ringShape(const SelectivelyRefinedMesh& mesh, VertexSlot slot,
                                  const glm::dvec3& eye, double pixelsAtOne);

[[nodiscard]] glm::dvec3 eyeOnGrid(const Camera& camera, const Quantization& quantization);

}  // namespace meshfront::evaluation
