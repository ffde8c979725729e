#include "shared/scene/likely_error.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace meshfront {
namespace {

// How much more a pixel of another surface differs than one of another shade.
constexpr double kSilhouetteContrast = 4;
// The log2 of an error that is lifted by 0: a pixel whose normals vary by a thousandth.
constexpr double kSmallestError = -10;

class RingLooker {
 public:
  RingLooker(const SelectivelyRefinedMesh& mesh, const glm::dvec3& eye, double pixelsAtOne)
      : mesh_(mesh), eye_(eye), pixelsAtOne_(pixelsAtOne) {}

  [[nodiscard]] double errorAt(VertexSlot slot, uint32_t pixels) const {
    const HalfEdgeMesh& edges = mesh_.edges();
    const glm::dvec3 here = at(slot);
    const glm::dvec3 toEye = eye_ - here;
    const double distance = std::max(glm::length(toEye), 1.0);
    glm::dvec3 sum(0);
    double area = 0;
    double lengths = 0;
    double silhouette = 0;
    unsigned count = 0;
    edges.forEachOutgoing(slot, [&](HalfEdge h) {
      const VertexSlot next = edges.destination(h);
      if (!isReal(next)) return;
      const glm::dvec3 along = at(next) - here;
      lengths += glm::length(along);
      ++count;
      const VertexSlot left = edges.origin(HalfEdgeMesh::previous(h));
      const VertexSlot right = edges.origin(HalfEdgeMesh::previous(edges.twin(h)));
      bool facesLeft = false;
      if (isReal(left)) {
        const glm::dvec3 normal = glm::cross(along, at(left) - here);
        sum += normal;
        area += glm::length(normal);
        facesLeft = glm::dot(normal, toEye) > 0;
      }
      const bool facesRight =
          isReal(right) && glm::dot(glm::cross(at(right) - here, along), toEye) > 0;
      if (isReal(left) && isReal(right) && facesLeft == facesRight) return;
      const glm::dvec3 way = toEye / distance;
      silhouette += glm::length(along - glm::dot(along, way) * way);
    });
    if (count == 0 || area == 0) return 0;
    const double share = glm::length(sum) / area;
    const double variance = std::clamp(1 - share * share, 0.0, 1.0);
    const double pixelsAStep = pixelsAtOne_ / distance;
    const double sagitta = lengths / count * std::sqrt(variance) / 8;
    return pixels * variance +
           kSilhouetteContrast * silhouette * sagitta * pixelsAStep * pixelsAStep;
  }

 private:
  [[nodiscard]] glm::dvec3 at(VertexSlot slot) const {
    const GridPosition& p = mesh_.positions()[slot];
    return {p[0], p[1], p[2]};
  }
  [[nodiscard]] bool isReal(VertexSlot slot) const { return !mesh_.isVirtual(mesh_.nodeAt(slot)); }

  const SelectivelyRefinedMesh& mesh_;
  const glm::dvec3 eye_;
  const double pixelsAtOne_;
};

}  // namespace

void liftByLikelyError(const SelectivelyRefinedMesh& mesh, std::span<const uint32_t> pixels,
                       const glm::dvec3& eye, double pixelsAtOne, std::vector<uint8_t>& lift) {
  const RingLooker looker(mesh, eye, pixelsAtOne);
  const size_t count = std::min(pixels.size(), mesh.vertexSlotCount());
  lift.resize(std::max(lift.size(), count), 0);
  for (VertexSlot slot = 0; slot < count; ++slot) {
    const NodeIndex node = mesh.nodeAt(slot);
    if (pixels[slot] == 0 || node == kNone || mesh.isVirtual(node) || mesh.isLeaf(node)) continue;
    const double levels =
        std::log2(std::max(looker.errorAt(slot, pixels[slot]), 1e-9)) - kSmallestError;
    lift[slot] = static_cast<uint8_t>(lift[slot] +
                                      std::lround(std::clamp(levels, 0.0, double{kMostErrorLift})));
  }
}

}  // namespace meshfront
