#include "shared/refinement/selectively_refined_mesh.h"

#include <algorithm>
#include <bit>

namespace meshfront {

Result<SelectivelyRefinedMesh> SelectivelyRefinedMesh::fromBase(BaseMesh base) {
  SelectivelyRefinedMesh mesh;
  const auto roots = static_cast<uint32_t>(base.roots.size());
  const uint32_t trees = base.treeCount();
  mesh.edges_ = HalfEdgeMesh(base.triangles, trees);
  mesh.firstVirtual_ = roots;
  mesh.endVirtual_ = trees;
  for (const auto& root : base.roots) mesh.positions_.push_back(root.position);
  const auto normals = baseNormals(mesh.positions_.span(), base.triangles);
  mesh.positions_.resize(trees);
  mesh.nodes_.resize((size_t{trees} + 1) / 2 * 2);
  if (trees % 2 != 0) mesh.nodes_[trees].flags = kForgotten | kLeaf;
  for (uint32_t tree = 0; tree < trees; ++tree) {
    const bool isVirtual = tree >= roots;
    Node& node = mesh.nodes_[tree];
    node.slot = tree;
    node.set(kLeaf, isVirtual || base.roots[tree].isLeaf);
    node.level = isVirtual ? 0 : base.roots[tree].level;
    if (!isVirtual) node.normal = normals[tree];
    mesh.slots_.push_back({NodeId::root(tree), mesh.positions_[tree], tree});
    mesh.occupants_.push_back({tree, 0});
    if (base.tables.attributes.layout.any())
      mesh.attributes_.push_back(isVirtual ? VertexAttributes{} : base.roots[tree].attributes);
  }
  mesh.drawn_.resize(mesh.edges_.faceSlots());
  for (FaceSlot face = 0; face < base.triangles.size(); ++face) {
    const Triangle& t = base.triangles[face];
    if (t[0] >= roots || t[1] >= roots || t[2] >= roots) continue;
    mesh.drawn_[face] = t;
    ++mesh.drawnCount_;
  }
  mesh.base_ = std::move(base);
  return mesh;
}

std::optional<NodeIndex> SelectivelyRefinedMesh::find(const NodeId& id) const {
  if (id.tree >= base_.treeCount()) return std::nullopt;
  unsigned depth = 0;
  if (found_.known && found_.id.tree == id.tree)
    depth = std::min({static_cast<unsigned>(std::countl_zero(found_.id.path ^ id.path)),
                      unsigned{found_.id.depth}, unsigned{id.depth}});
  NodeIndex node = depth == 0 ? id.tree : found_.nodes[depth];
  found_.nodes[0] = id.tree;
  for (; depth < id.depth; ++depth) {
    const NodeIndex left = nodes_[node].leftChild;
    if (left == kNone) break;
    node = left + (id.step(depth) ? 1 : 0);
    found_.nodes[depth + 1] = node;
  }
  found_.id = id;
  found_.id.depth = static_cast<uint8_t>(depth);
  found_.known = true;
  if (depth < id.depth) return std::nullopt;
  return node;
}

NodeId SelectivelyRefinedMesh::id(NodeIndex index) const {
  const Node* node = &nodes_[index];
  if (node->has(kForgotten)) return {};
  const uint8_t depth = node->depth;
  uint64_t path = 0;
  while (node->slot == kNone) {  // below the front
    const Node& parent = nodes_[node->parent];
    if (parent.leftChild != index) path |= uint64_t{1} << (64 - node->depth);
    index = node->parent;
    node = &parent;
  }
  // What else stands in the slot is below it on the left: steps of zero.
  const NodeId& at = slots_[node->slot].id;
  return {at.tree, depth, at.path | path};
}

GridMesh SelectivelyRefinedMesh::snapshot() const {
  GridMesh out;
  out.layout = attributeLayout();
  std::vector<uint32_t> number(slots_.size(), kNone);
  for (const Triangle& t : drawnCorners())
    if (t != Triangle{})
      for (const uint32_t corner : t) number[corner] = 0;
  for (uint32_t slot = 0; slot < number.size(); ++slot) {
    if (number[slot] == kNone) continue;
    number[slot] = static_cast<uint32_t>(out.positions.size());
    out.positions.push_back(positions_[slot]);
    if (!attributes_.empty()) out.attributes.push_back(attributes_[slot]);
  }
  for (const Triangle& t : drawnCorners())
    if (t != Triangle{}) out.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  return out;
}

size_t SelectivelyRefinedMesh::memoryBytes() const {
  return sizeof(*this) + base_.roots.capacity() * sizeof(BaseMesh::Root) +
         base_.triangles.capacity() * sizeof(Triangle) + base_.tables.memoryBytes() +
         nodes_.memoryBytes() + slots_.memoryBytes() + occupants_.memoryBytes() +
         positions_.memoryBytes() + attributes_.memoryBytes() + drawn_.memoryBytes() +
         edges_.memoryBytes() + longRecords_.memoryBytes() +
         (changed_ ? changed_->memoryBytes() : 0);
}

size_t SelectivelyRefinedMesh::drawerBytesWith(size_t vertexSlots, size_t faceSlots) {
  return vertexSlots * (sizeof(DrawnVertex) + sizeof(uint32_t)) + faceSlots * sizeof(Triangle);
}

size_t SelectivelyRefinedMesh::bytesAfter(size_t splits, size_t newRecords) const {
  constexpr uint64_t kLongRecordBits = 192;  // if it is too long for a node; with colours, mostly
  const size_t more = splits - std::min<size_t>(splits, edges_.freeVertices());
  const size_t vertices = slots_.size() + more;
  const size_t faces = drawn_.size() + 2 * more;
  const size_t pairs = newRecords - std::min(newRecords, freePairs_);
  size_t growth = 0;
  const auto add = [&growth](const auto& array, size_t size) {
    growth += array.memoryBytesFor(size) - array.memoryBytes();
  };
  add(nodes_, nodes_.size() + 2 * pairs);
  add(slots_, vertices);
  add(occupants_, vertices);
  add(positions_, vertices);
  if (!attributes_.empty()) add(attributes_, vertices);
  add(drawn_, faces);
  growth += edges_.memoryBytesAfter(splits) - edges_.memoryBytes();
  if (pairs > 0)
    growth +=
        longRecords_.memoryBytesAfter(newRecords * kLongRecordBits) - longRecords_.memoryBytes();
  if (changed_) {
    add(changed_->vertices, vertices);
    add(changed_->born, vertices);
    add(changed_->faces, faces);
  }
  return memoryBytes() + growth + drawerBytesWith(vertices, faces);
}

}  // namespace meshfront
