#include "shared/scene/seen_rim.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace meshfront {

SeenPixels seenPixels(const SelectivelyRefinedMesh& mesh, std::span<const uint32_t> pixels) {
  SeenPixels seen;
  const size_t slots = std::min(pixels.size(), mesh.vertexSlotCount());
  for (VertexSlot slot = 0; slot < slots; ++slot) {
    seen.all += pixels[slot];
    const NodeIndex node = mesh.nodeAt(slot);
    if (pixels[slot] == 0 || node == kNone || mesh.isLeaf(node) || mesh.isVirtual(node)) continue;
    seen.open += pixels[slot];
    ++seen.openNodes;
  }
  return seen;
}

std::vector<VertexSlot> openRim(const SelectivelyRefinedMesh& mesh,
                                std::span<const uint32_t> pixels, const glm::dvec3& eye,
                                double pixelsAtOne) {
  const auto at = [&mesh](VertexSlot slot) {
    const GridPosition& p = mesh.positions()[slot];
    return glm::dvec3(p[0], p[1], p[2]);
  };
  std::vector<VertexSlot> rim;
  const size_t slots = std::min(pixels.size(), mesh.vertexSlotCount());
  for (VertexSlot slot = 0; slot < slots; ++slot) {
    const NodeIndex node = mesh.nodeAt(slot);
    if (pixels[slot] > 0 || node == kNone || mesh.isLeaf(node) || mesh.isVirtual(node)) continue;
    const glm::dvec3 here = at(slot);
    const double shown = kRimEdgePixels * glm::distance(eye, here) / pixelsAtOne;
    bool touches = false;
    mesh.edges().forEachOutgoing(slot, [&](HalfEdge edge) {
      const VertexSlot next = mesh.edges().destination(edge);
      if (touches || next >= slots || pixels[next] == 0) return;
      touches = glm::distance(here, at(next)) >= shown;
    });
    if (touches) rim.push_back(slot);
  }
  return rim;
}

}  // namespace meshfront
