#include "shared/scene/seen_rim.h"

#include <algorithm>

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
                                std::span<const uint32_t> pixels) {
  std::vector<VertexSlot> rim;
  const size_t slots = std::min(pixels.size(), mesh.vertexSlotCount());
  for (VertexSlot slot = 0; slot < slots; ++slot) {
    const NodeIndex node = mesh.nodeAt(slot);
    if (pixels[slot] > 0 || node == kNone || mesh.isLeaf(node) || mesh.isVirtual(node)) continue;
    bool touches = false;
    mesh.edges().forEachOutgoing(slot, [&](HalfEdge edge) {
      const VertexSlot neighbour = mesh.edges().destination(edge);
      touches = touches || (neighbour < slots && pixels[neighbour] >= kRimPixels);
    });
    if (touches) rim.push_back(slot);
  }
  return rim;
}

}  // namespace meshfront
