// SelectivelyRefinedMesh: records kept in nodes, and forgetting what lies below the front.
#include "shared/refinement/selectively_refined_mesh.h"

namespace meshfront {

void SelectivelyRefinedMesh::store(Node& node, const Bits& bits) {
  forgetRecord(node);
  ++recordsHeld_;
  if (bits.length <= 8 * node.record.size()) {
    RecordPool::copyBits(bits.bytes, bits.begin, bits.length, node.record);
    node.recordBits = static_cast<uint8_t>(bits.length);
    return;
  }
  const PoolRecord in{longRecords_.keep(bits.bytes, bits.begin, bits.length), bits.length};
  std::memcpy(node.record.data(), &in, sizeof(in));
  node.recordBits = kInPool;
}

void SelectivelyRefinedMesh::forgetRecord(Node& node) {
  if (node.recordBits == 0) return;
  if (node.recordBits == kInPool) {
    PoolRecord in;
    std::memcpy(&in, node.record.data(), sizeof(in));
    longRecords_.drop(in.place, in.bits);
  }
  node.recordBits = 0;
  --recordsHeld_;
}

Result<void> SelectivelyRefinedMesh::keepRecord(NodeIndex index, std::span<const uint8_t> bytes,
                                                uint64_t bitOffset, uint32_t bitLength) {
  if (index >= nodes_.size() || !isKnown(index) || isLeaf(index))
    return fail("record: the node has none");
  if (bitLength == 0 || bitOffset > bytes.size() * 8 || bitLength > bytes.size() * 8 - bitOffset)
    return fail("record: its bits are not there");
  if (!hasRecord(index)) store(nodes_[index], {bytes, bitOffset, bitLength});
  return {};
}

bool SelectivelyRefinedMesh::anyPinnedBelow(NodeIndex index) const {
  const NodeIndex left = nodes_[index].leftChild;
  if (left == kNone) return false;
  return isPinned(left) || isPinned(left + 1) || anyPinnedBelow(left) || anyPinnedBelow(left + 1);
}

bool SelectivelyRefinedMesh::dropRecord(NodeIndex index, std::vector<NodeId>* forgotten) {
  if (!hasRecord(index)) return true;
  if (isSplit(index) || anyPinnedBelow(index)) return false;
  forgetBelow(index, forgotten);
  forgetRecord(nodes_[index]);
  return true;
}

size_t SelectivelyRefinedMesh::forgetBelow(NodeIndex index, std::vector<NodeId>* forgotten) {
  if (!isKnown(index) || isSplit(index)) return 0;
  size_t count = 0;
  forgetChildren(index, forgotten, count);
  if (count > 0) found_.known = false;
  return count;
}

// True if the node is left without children. Trees are at most kMaxDepth deep.
bool SelectivelyRefinedMesh::forgetChildren(NodeIndex index, std::vector<NodeId>* forgotten,
                                            size_t& count) {
  const NodeIndex left = nodes_[index].leftChild;
  if (left == kNone) return true;
  bool forgets = true;
  for (const NodeIndex child : {left, left + 1})
    forgets = forgetChildren(child, forgotten, count) && forgets;
  forgets = forgets && !isPinned(left) && !isPinned(left + 1);
  if (!forgets) return false;
  for (const NodeIndex child : {left, left + 1}) {
    if (forgotten != nullptr) forgotten->push_back(id(child));
    forgetRecord(nodes_[child]);
    ++count;
  }
  for (const NodeIndex child : {left, left + 1}) {
    nodes_[child] = Node{};
    nodes_[child].flags = kForgotten | kLeaf;
  }
  nodes_[left].parent = firstFreePair_;
  firstFreePair_ = left;
  ++freePairs_;
  nodes_[index].leftChild = kNone;
  return true;
}

}  // namespace meshfront
