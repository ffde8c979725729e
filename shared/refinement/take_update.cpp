// What a drawer must change: SelectivelyRefinedMesh::takeUpdate().
#include "shared/refinement/selectively_refined_mesh.h"

namespace meshfront {

MeshUpdate SelectivelyRefinedMesh::takeUpdate() {
  if (!changed_) {
    changed_.emplace();
    changed_->vertices.resize(positions_.size());
    changed_->born.resize(positions_.size());
    changed_->faces.resize(drawn_.size());
    for (VertexSlot slot = 0; slot < positions_.size(); ++slot) changed_->vertices.add(slot);
    for (FaceSlot face = 0; face < drawn_.size(); ++face) changed_->faces.add(face);
  }
  MeshUpdate update;
  update.changeCount = changes_;
  update.vertexSlots = positions_.size();
  update.faceSlots = drawn_.size();
  const bool normalsFollowFaces = attributeLayout().normalBits == 0;
  changed_->faces.forEach([&](FaceSlot face) {
    update.faces.push_back(face);
    update.corners.push_back(drawn_[face]);
    if (!normalsFollowFaces || !isDrawn(face)) return;
    for (const VertexSlot corner : drawn_[face]) changed_->vertices.add(corner);
  });
  changed_->vertices.forEach([&](VertexSlot slot) {
    if (nodeAt(slot) == kNone || isVirtualSlot(slot)) return;
    update.slots.push_back(slot);
    if (changed_->born.has(slot)) update.born.push_back(slot);
  });
  constexpr size_t kAhead = 4;
  update.vertices.reserve(update.slots.size());
  for (size_t i = 0; i < update.slots.size(); ++i) {
    if (normalsFollowFaces && i + kAhead < update.slots.size())
      edges_.prefetchFace(edges_.outgoing(update.slots[i + kAhead]));
    update.vertices.push_back(drawnVertex(update.slots[i]));
  }
  changed_->vertices.clear();
  changed_->born.clear();
  changed_->faces.clear();
  return update;
}

// To be called when the faces have been given to t, from entry `right` of the ring on.
void SelectivelyRefinedMesh::noteSplit(VertexSlot kept, const HalfEdgeMesh::Split& made,
                                       std::span<const HalfEdge> ring, uint32_t right) {
  changed_->vertices.resize(slots_.size());
  changed_->born.resize(slots_.size());
  changed_->faces.resize(drawn_.size());
  changed_->vertices.add(kept);
  changed_->vertices.add(made.vertex);
  changed_->born.add(made.vertex);
  changed_->faces.add(made.firstFace);
  changed_->faces.add(made.firstFace + 1);
  const auto size = static_cast<uint32_t>(ring.size());
  for (uint32_t i = 0; i < made.moved; ++i)
    changed_->faces.add(
        HalfEdgeMesh::faceOf(ring[right + i < size ? right + i : right + i - size]));
}

// To be called while the faces are there.
void SelectivelyRefinedMesh::noteCollapse(VertexSlot kept, VertexSlot freed, FaceSlot faces) {
  changed_->vertices.add(kept);
  changed_->born.remove(freed);
  edges_.forEachOutgoing(freed, [&](HalfEdge h) { changed_->faces.add(HalfEdgeMesh::faceOf(h)); });
  for (const FaceSlot face : {faces, faces + 1})
    for (uint32_t i = 0; i < 3; ++i)
      changed_->vertices.add(edges_.origin(HalfEdgeMesh::halfEdge(face, i)));
}

DrawnVertex SelectivelyRefinedMesh::drawnVertex(VertexSlot slot) const {
  const NodeIndex index = nodeAt(slot);
  const Node& node = nodes_[index];
  const NodeId& id = slots_[slot].id;
  DrawnVertex out;
  out.position = slots_[slot].position;
  out.from = slots_[slots_[slot].from].position;
  if (!attributes_.empty()) out.colour = attributes_[slot].colour;
  out.normal =
      attributeLayout().normalBits == 0
          ? normalOfDrawn(slot)
          : packUnitNormal(fromOctahedral(attributes_[slot].normal, attributeLayout().normalBits));
  out.tree = id.tree;
  out.level = node.has(kLeaf) ? 0 : node.level;
  out.isLeaf = node.has(kLeaf) ? 1 : 0;
  out.depth = id.depth;
  out.node = index;
  return out;
}

// As computeVertexNormals() of the whole mesh has it: sums of integers, in whatever order, and a
// triangle's part is the same from whichever corner.
PackedNormal SelectivelyRefinedMesh::normalOfDrawn(VertexSlot slot) const {
  NormalSum sum{};
  const GridPosition at = positions_[slot];
  VertexSlot end = edges_.destination(edges_.outgoing(slot));
  edges_.forEachOutgoing(slot, [&](HalfEdge h) {
    const VertexSlot begin = end;
    end = edges_.origin(HalfEdgeMesh::previous(h));
    if (isVirtualSlot(begin) || isVirtualSlot(end)) return;
    const NormalSum normal = areaNormal(at, positions_[begin], positions_[end]);
    for (size_t i = 0; i < 3; ++i) sum[i] += normal[i];
  });
  return packNormalSum(sum);
}

}  // namespace meshfront
