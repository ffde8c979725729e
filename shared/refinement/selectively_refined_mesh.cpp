#include "shared/refinement/selectively_refined_mesh.h"

#include <algorithm>
#include <bit>

#include "shared/codec/cut_coding.h"

namespace meshfront {

Result<SelectivelyRefinedMesh> SelectivelyRefinedMesh::fromBase(BaseMesh base) {
  SelectivelyRefinedMesh mesh;
  const auto roots = static_cast<uint32_t>(base.roots.size());
  const uint32_t trees = base.treeCount();
  mesh.edges_ = HalfEdgeMesh(base.triangles, trees);
  mesh.firstVirtual_ = roots;
  mesh.endVirtual_ = trees;
  for (const auto& root : base.roots) mesh.positions_.push_back(root.position);
  const auto normals = baseNormals(mesh.positions_, base.triangles);
  mesh.positions_.resize(trees);
  for (uint32_t tree = 0; tree < trees; ++tree) {
    const bool isVirtual = tree >= roots;
    mesh.ids_.push_back(NodeId::root(tree));
    mesh.aboveTurn_.push_back(kNone);
    Node node;
    node.slot = tree;
    node.isLeaf = isVirtual || base.roots[tree].isLeaf;
    node.level = isVirtual ? 0 : base.roots[tree].level;
    if (!isVirtual) {
      node.normal = normals[tree];
      node.position = base.roots[tree].position;
    }
    mesh.nodes_.push_back(node);
    mesh.nodeAt_.push_back(tree);
    if (base.tables.attributes.layout.any())
      mesh.nodeAttributes_.push_back(isVirtual ? VertexAttributes{} : base.roots[tree].attributes);
  }
  mesh.attributes_ = mesh.nodeAttributes_;
  for (const Triangle& t : base.triangles) {
    const bool drawn = t[0] < roots && t[1] < roots && t[2] < roots;
    mesh.drawn_.push_back(drawn ? t : Triangle{});
    mesh.drawnCount_ += drawn ? 1 : 0;
  }
  mesh.base_ = std::move(base);
  return mesh;
}

std::optional<NodeIndex> SelectivelyRefinedMesh::find(const NodeId& id) const {
  if (id.tree >= base_.treeCount()) return std::nullopt;
  NodeIndex node = id.tree;
  for (unsigned depth = 0; depth < id.depth; ++depth) {
    if (nodes_[node].leftChild == kNone) return std::nullopt;
    node = nodes_[node].leftChild + (id.step(depth) ? 1 : 0);
  }
  return node;
}

bool SelectivelyRefinedMesh::isActive(NodeIndex node) const {
  return nodes_[node].slot != kNone && nodeAt_[nodes_[node].slot] == node;
}

FaceKey SelectivelyRefinedMesh::keyOf(FaceSlot face) const {
  if (face < edges_.baseFaces()) return FaceKey::ofBase(face);
  const uint32_t behind = face - edges_.baseFaces();
  return FaceKey::of(ids_[creators_[behind / 2]], behind % 2 != 0);
}

void SelectivelyRefinedMesh::updateDrawn(FaceSlot face) {
  Triangle corners{};
  bool drawn = true;
  for (uint32_t i = 0; i < 3; ++i) {
    corners[i] = edges_.origin(3 * face + i);
    drawn = drawn && !isVirtualSlot(corners[i]);
  }
  drawn_[face] = drawn ? corners : Triangle{};
}

Result<void> SelectivelyRefinedMesh::split(NodeIndex index, std::span<const uint8_t> bytes,
                                           uint64_t bitOffset, uint32_t bitLength) {
  if (!isActive(index) || nodes_[index].isLeaf) return fail("split: the node is not splittable");
  if (auto applied = apply(index, bytes, bitOffset, bitLength); !applied) return applied;
  Node& node = nodes_[index];
  if (!node.hasRecord) {
    node.hasRecord = true;
    node.recordOffset = records_.bitCount();
    node.recordLength = bitLength;
    records_.append(bytes, bitOffset, bitLength);
    ++recordsHeld_;
  }
  return {};
}

Result<void> SelectivelyRefinedMesh::resplit(NodeIndex index) {
  if (!hasRecord(index) || !isActive(index)) return fail("split: no record kept for the node");
  return apply(index, records_.bytes(), nodes_[index].recordOffset, nodes_[index].recordLength);
}

Result<void> SelectivelyRefinedMesh::apply(NodeIndex index, std::span<const uint8_t> bytes,
                                           uint64_t bitOffset, uint32_t bitLength) {
  const Node node = nodes_[index];
  const NodeId id = ids_[index];
  BitReader in(bytes, bitOffset, bitOffset + bitLength);
  const Record record = readRecord(in, base_.tables, node.level);
  if (in.overrun() || record.cutEnd != bitLength) return fail("split: a damaged record");
  if (id.depth >= kMaxDepth) return fail("split: deeper than any tree");

  const unsigned a = mainAxis(node.normal);
  GridPosition delta{};
  delta[(a + 1) % 3] = record.deltaB;
  delta[(a + 2) % 3] = record.deltaC;
  delta[a] = predictedAlong(node.normal, a, record.deltaB, record.deltaC) + record.residualA;
  GridPosition position = node.position;
  const int32_t limit = static_cast<int32_t>(1U << base_.quantizationBits);
  for (size_t i = 0; i < 3; ++i) {
    position[i] += delta[i];
    if (position[i] < 0 || position[i] >= limit) return fail("split: a vertex outside the grid");
  }

  const bool carries = attributeLayout().any();
  VertexAttributes attributes;
  if (carries &&
      !addAttributes(nodeAttributes_[index], record.attributes, attributeLayout(), attributes))
    return fail("split: a colour or normal out of range");

  edges_.ring(node.slot, ring_);
  entries_.clear();
  for (const HalfEdge h : ring_) entries_.push_back(ids_[nodeAt_[edges_.destination(h)]]);
  CutDecoder coder(base_.tables, bytes, bitOffset + record.cutBegin, bitOffset + record.cutEnd);
  const auto positionOf = [&](uint32_t entry, unsigned depth) -> std::optional<GridPosition> {
    NodeIndex at = nodeAt_[edges_.destination(ring_[entry])];
    if (isVirtual(at)) return std::nullopt;
    // Left children stand where their parents stand, so only the right turns below `depth` count:
    // the last of them leads to the depth at which the path's last one stands.
    for (uint64_t path = entries_[entry].path; path != 0; path &= path - 1) {
      if (64U - static_cast<unsigned>(std::countr_zero(path)) <= depth) break;
      at = aboveTurn_[at];
    }
    return nodes_[at].position;
  };
  const RingCut cut = walkRing(
      std::span<const NodeId>(entries_), [&](uint32_t gap) { return keyOf(ring_[gap] / 3); },
      positionOf, CutFrame(node.position, delta, node.normal), coder, RingCut{}, space_);

  // From here on nothing fails.
  if (node.leftChild == kNone) {
    const auto first = static_cast<NodeIndex>(nodes_.size());
    const PredictedNormal normal = normalAfter(node.normal, delta);
    for (const bool right : {false, true}) {
      Node child;
      child.parent = index;
      child.isLeaf = right ? record.rightIsLeaf : record.leftIsLeaf;
      child.level = right ? record.rightLevel : record.leftLevel;
      child.normal = normal;
      child.position = right ? position : node.position;
      nodes_.push_back(child);
      if (carries) {
        const VertexAttributes kept = nodeAttributes_[index];
        nodeAttributes_.push_back(right ? attributes : kept);
      }
      aboveTurn_.push_back(right ? index : aboveTurn_[index]);
      ids_.push_back(id.child(right));
    }
    nodes_[index].leftChild = first;
  }
  const NodeIndex u = nodes_[index].leftChild;
  const auto made = edges_.split(node.slot, ring_, cut.left, cut.right, cut.leftFirst);
  if (made.vertex == positions_.size()) {
    positions_.push_back(position);
    nodeAt_.push_back(u + 1);
  } else {
    positions_[made.vertex] = position;
    nodeAt_[made.vertex] = u + 1;
  }
  if (carries) {
    attributes_.resize(positions_.size());
    attributes_[made.vertex] = attributes;
  }
  nodeAt_[node.slot] = u;
  nodes_[u].slot = node.slot;
  nodes_[u + 1].slot = made.vertex;

  if (made.firstFace == drawn_.size()) {
    drawn_.resize(drawn_.size() + 2);
    creators_.push_back(index);
  } else {
    creators_[(made.firstFace - edges_.baseFaces()) / 2] = index;
  }
  nodes_[index].faces = made.firstFace;
  updateDrawn(made.firstFace);
  updateDrawn(made.firstFace + 1);
  for (const HalfEdge h : ring_)
    if (edges_.origin(h) == made.vertex && drawn_[h / 3] != Triangle{}) updateDrawn(h / 3);
  drawnCount_ += isDrawn(made.firstFace) + isDrawn(made.firstFace + 1);
  ++splitsApplied_;
  ++changes_;
  return {};
}

bool SelectivelyRefinedMesh::canCollapse(NodeIndex node) const {
  const NodeIndex left = nodes_[node].leftChild;
  return left != kNone && isActive(left) && isActive(left + 1);
}

void SelectivelyRefinedMesh::collapse(NodeIndex index) {
  const NodeIndex u = nodes_[index].leftChild;
  const VertexSlot kept = nodes_[u].slot;
  const VertexSlot freed = nodes_[u + 1].slot;
  const FaceSlot faces = nodes_[index].faces;
  drawnCount_ -= isDrawn(faces) + isDrawn(faces + 1);
  edges_.ring(freed, ring_);
  edges_.collapse(faces);
  drawn_[faces] = drawn_[faces + 1] = Triangle{};
  for (const HalfEdge h : ring_)
    if (drawn_[h / 3] != Triangle{}) updateDrawn(h / 3);
  nodes_[u].slot = nodes_[u + 1].slot = kNone;
  nodeAt_[freed] = kNone;
  nodeAt_[kept] = index;
  --splitsApplied_;
  ++changes_;
}

GridMesh SelectivelyRefinedMesh::snapshot() const {
  GridMesh out;
  out.layout = attributeLayout();
  std::vector<uint32_t> number(positions_.size(), kNone);
  for (const Triangle& t : drawn_)
    if (t != Triangle{})
      for (const uint32_t corner : t) number[corner] = 0;
  for (uint32_t slot = 0; slot < number.size(); ++slot) {
    if (number[slot] == kNone) continue;
    number[slot] = static_cast<uint32_t>(out.positions.size());
    out.positions.push_back(positions_[slot]);
    if (!attributes_.empty()) out.attributes.push_back(attributes_[slot]);
  }
  for (const Triangle& t : drawn_)
    if (t != Triangle{}) out.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  return out;
}

}  // namespace meshfront
