#include "tests/evaluation/sender_driven/full_decoding.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace meshfront::evaluation {

Result<FullDecoding> FullDecoding::of(const BaseMesh& base,
                                      std::span<const std::span<const uint8_t>> chunks) {
  auto mesh = SelectivelyRefinedMesh::fromBase(base);
  if (!mesh) return tl::unexpected(mesh.error());
  FullDecoding decoding(std::move(*mesh));
  for (uint32_t i = 0; i < chunks.size(); ++i)
    if (auto split = decoding.splitChunk(i, chunks[i]); !split)
      return tl::unexpected(split.error());
  if (!decoding.mesh_.complete()) return fail("the chunks do not make up the whole mesh");
  decoding.measureLeaves();
  return decoding;
}

Result<void> FullDecoding::splitChunk(uint32_t number, std::span<const uint8_t> bytes) {
  const auto chunk = decodeChunk(bytes, mesh_.base().tables);
  if (!chunk) return tl::unexpected(chunk.error());
  for (const RecordEntry& entry : chunk->entries) {
    const auto node = mesh_.find(entry.id);
    if (!node || !mesh_.isActive(*node)) return fail("a record's parent is missing");
    const VertexSlot slot = mesh_.slot(*node);
    // The ring as it is before the split; where the new vertex stands is known after it.
    ring_.clear();
    mesh_.edges().forEachOutgoing(slot, [&](HalfEdge h) {
      const FaceSlot face = HalfEdgeMesh::faceOf(h);
      const Triangle& corners = mesh_.drawnCorners()[face];
      if (corners[0] == corners[1]) return;
      std::array<glm::dvec3, 3> triangle{};
      for (size_t i = 0; i < 3; ++i) triangle[i] = gridPoint(mesh_.positions()[corners[i]]);
      ring_.push_back(triangle);
    });
    if (auto split = mesh_.split(*node, bytes, entry.bitOffset, entry.bitLength); !split)
      return tl::unexpected(split.error());
    const glm::dvec3 point = gridPoint(mesh_.position(mesh_.leftChild(*node) + 1));
    const double error = distanceFromRing(slot, point);
    records_.push_back({entry, number, static_cast<float>(error), *node});
  }
  return {};
}

double FullDecoding::distanceFromRing(VertexSlot slot, const glm::dvec3& point) const {
  // A vertex without a drawn face: its own place is all there was.
  double nearest = glm::length(point - gridPoint(mesh_.positions()[slot]));
  for (const auto& triangle : ring_)
    nearest = std::min(nearest, distanceToTriangle(point, triangle));
  return nearest;
}

// Pictures show both sides of a surface; a cone of normals tells what looks away only where they
// look outwards. By the sign of the volume about the middle of all vertices, which holds for closed
// surfaces, those with small holes, and terrains seen from the side that their normals are on.
bool FullDecoding::isInsideOut() const {
  const auto positions = mesh_.positions();
  glm::dvec3 middle(0);
  for (const GridPosition& position : positions) middle += gridPoint(position);
  middle /= static_cast<double>(std::max<size_t>(positions.size(), 1));
  double volume = 0;
  for (const Triangle& corners : mesh_.drawnCorners()) {
    if (corners[0] == corners[1]) continue;
    volume += glm::dot(gridPoint(positions[corners[0]]) - middle,
                       glm::cross(gridPoint(positions[corners[1]]) - middle,
                                  gridPoint(positions[corners[2]]) - middle));
  }
  return volume < 0;
}

void FullDecoding::measureLeaves() {
  extents_.resize(mesh_.vertexSlotCount());
  const auto positions = mesh_.positions();
  for (uint32_t slot = 0; slot < extents_.size(); ++slot)
    extents_[slot].includePoint(gridPoint(positions[slot]));
  const double outwards = isInsideOut() ? -1 : 1;
  for (const Triangle& corners : mesh_.drawnCorners()) {
    if (corners[0] == corners[1]) continue;
    const std::array<glm::dvec3, 3> at{gridPoint(positions[corners[0]]),
                                       gridPoint(positions[corners[1]]),
                                       gridPoint(positions[corners[2]])};
    const glm::dvec3 normal = glm::cross(at[1] - at[0], at[2] - at[0]);
    const double area = glm::length(normal);
    for (size_t i = 0; i < 3; ++i) {
      NodeExtent& extent = extents_[corners[i]];
      extent.includePoint(at[(i + 1) % 3]);
      extent.includePoint(at[(i + 2) % 3]);
      if (area > 0) extent.includeNormal(outwards / area * normal);
    }
  }
}

}  // namespace meshfront::evaluation
