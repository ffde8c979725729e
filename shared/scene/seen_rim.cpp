#include "shared/scene/seen_rim.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace meshfront {

SeenPixels seenPixels(const SelectivelyRefinedMesh& mesh, std::span<const uint32_t> pixels) {
  SeenPixels seen;
  const size_t slots = std::min(pixels.size(), mesh.vertexSlotCount());
  for (VertexSlot slot = 0; slot < slots; ++slot) {
    seen.all += pixels[slot];
    seen.nodes += pixels[slot] > 0 ? 1 : 0;
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
  const auto slots = static_cast<VertexSlot>(std::min(pixels.size(), mesh.vertexSlotCount()));
  std::vector<uint8_t> isRim(slots, 0);
  for (VertexSlot seen = 0; seen < slots; ++seen) {
    if (pixels[seen] == 0 || mesh.nodeAt(seen) == kNone) continue;
    mesh.edges().forEachOutgoing(seen, [&](HalfEdge edge) {
      const VertexSlot slot = mesh.edges().destination(edge);
      if (slot >= slots || pixels[slot] > 0 || isRim[slot] != 0) return;
      const NodeIndex node = mesh.nodeAt(slot);
      if (mesh.isLeaf(node) || mesh.isVirtual(node)) return;
      const glm::dvec3 here = at(slot);
      const double shown = kRimEdgePixels * glm::distance(eye, here) / pixelsAtOne;
      if (glm::distance(here, at(seen)) >= shown) isRim[slot] = 1;
    });
  }
  std::vector<VertexSlot> rim;
  for (VertexSlot slot = 0; slot < slots; ++slot)
    if (isRim[slot] != 0) rim.push_back(slot);
  return rim;
}

}  // namespace meshfront
