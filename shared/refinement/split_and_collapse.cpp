// SelectivelyRefinedMesh: what changes the front.
#include <algorithm>

#include "shared/codec/cut_coding.h"
#include "shared/refinement/selectively_refined_mesh.h"

namespace meshfront {

Result<void> SelectivelyRefinedMesh::split(NodeIndex index, std::span<const uint8_t> bytes,
                                           uint64_t bitOffset, uint32_t bitLength) {
  if (!isActive(index) || isLeaf(index)) return fail("split: the node is not splittable");
  // One that was split before is split alike: its children are there.
  if (nodes_[index].leftChild != kNone && hasRecord(index)) return resplit(index);
  const Bits bits{bytes, bitOffset, bitLength};
  if (auto applied = apply(index, bits); !applied) return applied;
  store(nodes_[index], bits);
  return {};
}

Result<void> SelectivelyRefinedMesh::resplit(NodeIndex index) {
  if (!hasRecord(index) || !isActive(index)) return fail("split: no record kept for the node");
  const Node& node = nodes_[index];
  if (node.recordBits == kInPool) {
    PoolRecord in;
    std::memcpy(&in, node.record.data(), sizeof(in));
    return apply(index, {longRecords_.bytes(in.place, in.bits), 0, in.bits});
  }
  // With room behind it, so that readers take whole words.
  std::array<uint8_t, 24> bytes{};
  std::copy(node.record.begin(), node.record.end(), bytes.begin());
  return apply(index, {bytes, 0, node.recordBits});
}

void SelectivelyRefinedMesh::prefetch(NodeIndex index, Fetch stage) const {
  if (stage == Fetch::node) {
    __builtin_prefetch(&nodes_[index]);
    return;
  }
  const VertexSlot slot = nodes_[index].slot;
  if (slot == kNone) return;
  if (stage == Fetch::slot) {
    __builtin_prefetch(&slots_[slot]);
    __builtin_prefetch(&occupants_[slot]);
    edges_.prefetchOutgoing(slot);
  } else if (stage == Fetch::firstFace) {
    edges_.prefetchFace(edges_.outgoing(slot));
  } else {
    // The neighbours at the first face, and the faces on both sides of it.
    const HalfEdge first = edges_.outgoing(slot);
    __builtin_prefetch(&slots_[edges_.destination(first)]);
    __builtin_prefetch(&slots_[edges_.origin(HalfEdgeMesh::previous(first))]);
    edges_.prefetchFace(edges_.twin(first));
    edges_.prefetchFace(edges_.twin(HalfEdgeMesh::previous(first)));
  }
}

Result<void> SelectivelyRefinedMesh::apply(NodeIndex index, const Bits& bits) {
  const Node& node = nodes_[index];
  const VertexSlot slot = node.slot;
  const GridPosition from = slots_[slot].position;
  BitReader in(bits.bytes, bits.begin, bits.begin + bits.length);
  const Record record = readRecord(in, base_.tables, node.level);
  if (in.overrun() || record.cutEnd != bits.length) return fail("split: a damaged record");
  if (node.depth >= kMaxDepth) return fail("split: deeper than any tree");

  const unsigned a = mainAxis(node.normal);
  GridPosition delta{};
  delta[(a + 1) % 3] = record.deltaB;
  delta[(a + 2) % 3] = record.deltaC;
  delta[a] = predictedAlong(node.normal, a, record.deltaB, record.deltaC) + record.residualA;
  GridPosition position = from;
  const int32_t limit = static_cast<int32_t>(1U << base_.quantizationBits);
  for (size_t i = 0; i < 3; ++i) {
    position[i] += delta[i];
    if (position[i] < 0 || position[i] >= limit) return fail("split: a vertex outside the grid");
  }

  const bool carries = attributeLayout().any();
  VertexAttributes attributes;
  if (carries &&
      !addAttributes(attributes_[slot], record.attributes, attributeLayout(), attributes))
    return fail("split: a colour or normal out of range");

  const uint32_t size = gatherRing(slot);
  const std::span<const HalfEdge> ring(ring_.data(), size);
  CutDecoder coder(base_.tables, bits.bytes, bits.begin + record.cutBegin,
                   bits.begin + record.cutEnd);
  const auto positionOf = [&](uint32_t entry, unsigned depth) -> const GridPosition* {
    VertexSlot at = ends_[entry];
    if (isVirtualSlot(at)) return nullptr;
    // Left children stand where their parents stand, so only the right turns below `depth` count:
    // each leads to the slot that its parent's vertex still has.
    // How many there are, mostly none to three, cannot be guessed: so four are taken without
    // asking.
    uint64_t turns = depth < 64 ? entries_[entry].path << depth : 0;
    do {
      for (unsigned step = 0; step < 4; ++step) {
        const uint32_t whenLeft = turns != 0 ? UINT32_MAX : 0;
        at ^= (at ^ slots_[at].from) & whenLeft;
        turns &= turns - 1;
      }
    } while (turns != 0);
    return &slots_[at].position;
  };
  const RingCut cut = walkRing(
      std::span<const NodeId>(entries_.data(), size),
      [&](uint32_t gap) { return keyOf(HalfEdgeMesh::faceOf(ring_[gap])); }, positionOf,
      CutFrame(from, delta, node.normal), coder, RingCut{});

  // From here on nothing fails.
  NodeId id = slots_[slot].id;
  id.depth = node.depth;
  if (node.leftChild == kNone) addChildren(index, record, delta);
  const auto made = edges_.split(slot, ring, cut.left, cut.right, cut.leftFirst, id);
  place(index, made, position);
  if (carries) attributes_[made.vertex] = attributes;

  for (uint32_t i = 0; i < made.moved; ++i) {
    const HalfEdge h = ring[cut.right + i < size ? cut.right + i : cut.right + i - size];
    if (isDrawn(HalfEdgeMesh::faceOf(h))) drawn_[HalfEdgeMesh::faceOf(h)][h & 3] = made.vertex;
  }
  if (changed_) noteSplit(slot, made, ring, cut.right);
  ++splitsApplied_;
  ++changes_;
  return {};
}

// Fills ring_, ends_ and entries_; returns how many there are.
uint32_t SelectivelyRefinedMesh::gatherRing(VertexSlot slot) {
  uint32_t size = 0;
  auto capacity = static_cast<uint32_t>(ring_.size());
  HalfEdge* ring = ring_.data();
  VertexSlot* ends = ends_.data();
  NodeId* entries = entries_.data();
  edges_.forEachOutgoing(slot, [&](HalfEdge h) {
    if (size == capacity) {
      capacity = std::max<uint32_t>(64, 2 * capacity);
      ring_.resize(capacity);
      ends_.resize(capacity);
      entries_.resize(capacity);
      ring = ring_.data();
      ends = ends_.data();
      entries = entries_.data();
    }
    const VertexSlot end = edges_.destination(h);
    ring[size] = h;
    ends[size] = end;
    entries[size] = slots_[end].id;
    ++size;
  });
  return size;
}

// The children of a node that is split for the first time, or again after they were forgotten.
void SelectivelyRefinedMesh::addChildren(NodeIndex index, const Record& record,
                                         const GridPosition& delta) {
  NodeIndex left = firstFreePair_;
  if (left == kNone) {
    left = static_cast<NodeIndex>(nodes_.size());
    nodes_.append();
    nodes_.append();
  } else {
    firstFreePair_ = nodes_[left].parent;
    --freePairs_;
  }
  Node child;
  child.parent = index;
  child.normal = normalAfter(nodes_[index].normal, delta);
  child.depth = static_cast<uint8_t>(nodes_[index].depth + 1);
  child.level = record.leftLevel;
  child.set(kLeaf, record.leftIsLeaf);
  nodes_[left] = child;
  child.level = record.rightLevel;
  child.set(kLeaf, record.rightIsLeaf);
  nodes_[left + 1] = child;
  nodes_[index].leftChild = left;
}

// Gives the children their slots and the pair of faces its place among those that are drawn.
void SelectivelyRefinedMesh::place(NodeIndex index, const HalfEdgeMesh::Split& made,
                                   const GridPosition& position) {
  const NodeIndex left = nodes_[index].leftChild;
  const VertexSlot slot = nodes_[index].slot;
  nodes_[left].slot = slot;
  nodes_[left + 1].slot = made.vertex;
  if (made.vertex == slots_.size()) {
    slots_.append();
    occupants_.append();
    positions_.append();
    if (attributeLayout().any()) attributes_.append();
    drawn_.append();
    drawn_.append();
  }
  Slot& right = slots_[made.vertex];
  right.id = slots_[slot].id;
  right.id.depth = nodes_[index].depth;
  right.id = right.id.child(true);
  right.position = position;
  right.from = slot;
  positions_[made.vertex] = position;
  slots_[slot].id.depth = right.id.depth;  // the left child
  const auto now = static_cast<uint32_t>(changes_ + 1);
  occupants_[slot] = {left, now};
  occupants_[made.vertex] = {left + 1, now};
  updateDrawn(made.firstFace);
  updateDrawn(made.firstFace + 1);
  drawnCount_ += (isDrawn(made.firstFace) ? 1 : 0) + (isDrawn(made.firstFace + 1) ? 1 : 0);
}

void SelectivelyRefinedMesh::updateDrawn(FaceSlot face) {
  Triangle corners{};
  bool drawn = true;
  for (uint32_t i = 0; i < 3; ++i) {
    corners[i] = edges_.origin(HalfEdgeMesh::halfEdge(face, i));
    drawn = drawn && !isVirtualSlot(corners[i]);
  }
  drawn_[face] = drawn ? corners : Triangle{};
}

void SelectivelyRefinedMesh::collapse(NodeIndex index) {
  Node& left = nodes_[nodes_[index].leftChild];
  Node& right = nodes_[nodes_[index].leftChild + 1];
  const VertexSlot kept = left.slot;
  const VertexSlot freed = right.slot;
  const FaceSlot faces = edges_.facesOf(freed);
  drawnCount_ -= (isDrawn(faces) ? 1 : 0) + (isDrawn(faces + 1) ? 1 : 0);
  if (changed_) noteCollapse(kept, freed, faces);
  edges_.forEachOutgoing(freed, [&](HalfEdge h) {
    Triangle& drawn = drawn_[HalfEdgeMesh::faceOf(h)];
    if (drawn[0] != drawn[1]) drawn[h & 3] = kept;
  });
  edges_.collapse(freed);
  drawn_[faces] = drawn_[faces + 1] = Triangle{};
  left.slot = right.slot = kNone;
  slots_[kept].id.depth = nodes_[index].depth;
  --splitsApplied_;
  ++changes_;
  occupants_[freed].node = kNone;
  occupants_[kept] = {index, static_cast<uint32_t>(changes_)};
}

}  // namespace meshfront
