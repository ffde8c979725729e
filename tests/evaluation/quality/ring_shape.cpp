#include "tests/evaluation/quality/ring_shape.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace meshfront::evaluation {

RingShape ringShape(const SelectivelyRefinedMesh& mesh, VertexSlot slot, const glm::dvec3& eye,
                    double pixelsAtOne) {
  const HalfEdgeMesh& edges = mesh.edges();
  const auto at = [&mesh](VertexSlot vertex) {
    const GridPosition& p = mesh.positions()[vertex];
    return glm::dvec3(p[0], p[1], p[2]);
  };
  const auto isReal = [&mesh](VertexSlot vertex) { return !mesh.isVirtual(mesh.nodeAt(vertex)); };
  const glm::dvec3 here = at(slot);
  RingShape shape;
  shape.pixelsAStep = pixelsAtOne / std::max(glm::length(eye - here), 1.0);
  glm::dvec3 sum(0);
  double edgeSum = 0;
  unsigned edgeCount = 0;
  // The face on the other side of an edge is that of the edge before, counter-clockwise.
  edges.forEachOutgoing(slot, [&](HalfEdge h) {
    const VertexSlot next = edges.destination(h);
    if (!isReal(next)) return;
    const glm::dvec3 along = at(next) - here;
    edgeSum += glm::length(along);
    ++edgeCount;
    const auto areaNormal = [&](VertexSlot third, double sign) {
      return sign * 0.5 * glm::cross(along, at(third) - here);
    };
    const VertexSlot left = edges.origin(HalfEdgeMesh::previous(h));
    const VertexSlot right = edges.origin(HalfEdgeMesh::previous(edges.twin(h)));
    const bool hasLeft = isReal(left);
    const bool hasRight = isReal(right);
    const glm::dvec3 leftNormal = hasLeft ? areaNormal(left, 1) : glm::dvec3(0);
    const glm::dvec3 rightNormal = hasRight ? areaNormal(right, -1) : glm::dvec3(0);
    if (hasLeft) {
      sum += leftNormal;
      shape.area += glm::length(leftNormal);
    }
    const bool leftFaces = glm::dot(leftNormal, eye - here) > 0;
    const bool rightFaces = glm::dot(rightNormal, eye - here) > 0;
    if (!hasLeft || !hasRight || leftFaces != rightFaces) {
      const glm::dvec3 way = glm::normalize(eye - here);
      shape.silhouettePixels += glm::length(along - glm::dot(along, way) * way) * shape.pixelsAStep;
    }
  });
  if (edgeCount > 0) shape.edgeLength = edgeSum / edgeCount;
  if (shape.area > 0) {
    const double share = glm::length(sum) / shape.area;
    shape.normalVariance = std::clamp(1 - share * share, 0.0, 1.0);
    const double length = glm::length(sum) * glm::length(eye - here);
    if (length > 0) shape.facing = glm::dot(sum, eye - here) / length;
  }
  return shape;
}

glm::dvec3 eyeOnGrid(const Camera& camera, const Quantization& quantization) {
  const auto& origin = quantization.origin;
  return (camera.eye - glm::dvec3(origin[0], origin[1], origin[2])) / quantization.step;
}

}  // namespace meshfront::evaluation
