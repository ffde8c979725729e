#include <algorithm>
#include <bit>

#include "shared/bits/integer_codes.h"
#include "tests/evaluation/sender_driven/split_message.h"

namespace meshfront::evaluation {

std::span<const uint8_t> IdWriter::write(std::span<const uint32_t> nodes, const ActiveTags* sent,
                                         IdChances& chances) {
  nodes_ = nodes;
  at_ = 0;
  bytes_.clear();
  if (coding_ == IdCoding::adaptive && sent != nullptr) {
    writeAdaptive(*sent, chances);
    return bytes_;
  }
  BitWriter out;
  out.reserve(nodes.size() * 2);
  if (coding_ == IdCoding::published) {
    writePublished(out);
  } else {
    writeBitstring(out);
  }
  bytes_ = out.take();
  return bytes_;
}

unsigned IdWriter::publishedBits(const SenderModel& model, uint32_t node) {
  return static_cast<unsigned>(std::bit_width(model.base().treeCount())) + 6 + model.id(node).depth;
}

void IdWriter::writePublished(BitWriter& out) const {
  const auto treeBits = static_cast<unsigned>(std::bit_width(model_.base().treeCount()));
  for (const uint32_t node : nodes_) {
    const NodeId& id = model_.id(node);
    out.write(id.tree, treeBits);
    out.write(id.depth, 6);
    if (id.depth == 0) continue;
    const unsigned upper = id.depth > 32 ? 32 : id.depth;
    out.write(id.path >> (64 - upper), upper);
    if (id.depth > upper) out.write(id.path << upper >> (64 - id.depth + upper), id.depth - upper);
  }
}

void IdWriter::writeBitstring(BitWriter& out) {
  uint64_t trees = 0;
  size_t at = 0;
  for (const uint32_t root : model_.roots()) {
    const size_t end = behind(at, model_.end(root));
    if (end > at) ++trees;
    at = end;
  }
  writeExpGolomb(out, trees, 3);
  uint32_t nextTree = 0;
  for (const uint32_t root : model_.roots()) {
    const size_t end = behind(at_, model_.end(root));
    if (end == at_) continue;
    const uint32_t tree = model_.id(root).tree;
    writeExpGolomb(out, tree - nextTree, 0);
    nextTree = tree + 1;
    writeVisit(out, root, end);
  }
  at_ = 0;
  while (at_ < nodes_.size()) writeFollowing(out, nodes_[at_++]);
}

size_t IdWriter::behind(size_t from, uint32_t end) const {
  if (from >= nodes_.size() || nodes_[from] >= end) return from;
  // Steps that double: what is asked for is mostly near.
  size_t step = 1;
  while (from + step < nodes_.size() && nodes_[from + step] < end) {
    from += step;
    step *= 2;
  }
  const size_t last = std::min(from + step, nodes_.size());
  return static_cast<size_t>(std::lower_bound(nodes_.begin() + static_cast<std::ptrdiff_t>(from),
                                              nodes_.begin() + static_cast<std::ptrdiff_t>(last),
                                              end) -
                             nodes_.begin());
}

void IdWriter::writeVisit(BitWriter& out, uint32_t node, size_t end) {
  if (nodes_[at_] == node) {
    // On the client's front. All of the batch below hangs together with it.
    out.write(0, 2);
    at_ = end;
    return;
  }
  const uint32_t left = model_.leftChild(node);
  const uint32_t right = model_.rightChild(node);
  const size_t middle = left == kNoNode ? at_ : behind(at_, model_.end(left));
  const bool hasLeft = middle > at_;
  const bool hasRight = end > middle;
  out.write((hasLeft ? 2U : 0U) | (hasRight ? 1U : 0U), 2);
  if (hasLeft) writeVisit(out, left, middle);
  if (hasRight) writeVisit(out, right, end);
}

void IdWriter::writeFollowing(BitWriter& out, uint32_t node) {
  for (const uint32_t child : {model_.leftChild(node), model_.rightChild(node)}) {
    if (child == kNoNode) continue;
    const bool follows = nextNode() == child;
    out.writeBit(follows);
    if (!follows) continue;
    ++at_;
    writeFollowing(out, child);
  }
}

void IdWriter::writeAdaptive(const ActiveTags& sent, IdChances& chances) {
  AdaptiveBitWriter out(bytes_);
  for (const uint32_t root : model_.roots()) {
    const bool inBatch = nextNode() == root;
    const bool any = nextNode() < model_.end(root);
    const bool active = inBatch || !sent.has(model_.level(root), model_.tag(root));
    out.write(any, chances.of(active ? IdChances::Child::active : IdChances::Child::split,
                              IdChances::Sibling::none, model_.level(root)));
    if (!any) continue;
    if (inBatch) ++at_;
    walk(out, root, inBatch, sent, chances);
  }
  out.finish();
}

void IdWriter::walk(AdaptiveBitWriter& out, uint32_t node, bool inBatch, const ActiveTags& sent,
                    IdChances& chances) {
  auto sibling = IdChances::Sibling::none;
  const uint32_t left = model_.leftChild(node);
  for (const uint32_t child : {left, model_.rightChild(node)}) {
    if (child == kNoNode) continue;
    const unsigned level = model_.level(child);
    const bool sentNow = nextNode() == child;
    const bool any = nextNode() < model_.end(child);
    const auto kind = inBatch                                          ? IdChances::Child::born
                      : !sentNow && sent.has(level, model_.tag(child)) ? IdChances::Child::split
                                                                       : IdChances::Child::active;
    // Where the left one is out, what is known to be there is to the right.
    const bool known =
        !inBatch && child != left && (left == kNoNode || sibling == IdChances::Sibling::without);
    if (!known) out.write(any, chances.of(kind, sibling, level));
    sibling = any ? IdChances::Sibling::with : IdChances::Sibling::without;
    if (!any) continue;
    if (sentNow) ++at_;
    walk(out, child, sentNow, sent, chances);
  }
}

}  // namespace meshfront::evaluation
