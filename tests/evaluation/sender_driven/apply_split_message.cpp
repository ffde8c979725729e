#include <bit>

#include "shared/bits/bit_reader.h"
#include "shared/bits/integer_codes.h"
#include "shared/codec/record.h"
#include "shared/hierarchy/tree_bitstring.h"
#include "tests/evaluation/sender_driven/split_message.h"

namespace meshfront::evaluation {
namespace {

// The decoder of a message. Everything in it is untrusted.
class MessageApplication {
 public:
  MessageApplication(std::span<const uint8_t> message, SelectivelyRefinedMesh& mesh,
                     ClientSession& session)
      : message_(message), mesh_(mesh), session_(session) {}

  Result<uint64_t> apply() {
    BitReader header(message_);
    const auto coding = header.read(2);
    criteria_ = header.readBit();
    count_ = readExpGolomb(header, kMessageCountOrder);
    const uint64_t idBytes = readExpGolomb(header, kMessageCountOrder);
    const uint64_t idBegin = (header.position() + 7) / 8;
    if (header.overrun() || idBytes > message_.size() || idBegin > message_.size() - idBytes)
      return fail("a message of splits is cut short");
    ids_ = message_.subspan(idBegin, idBytes);
    records_ = BitReader(message_, 8 * (idBegin + idBytes), 8 * message_.size());
    bool sound = false;
    if (coding == static_cast<unsigned>(IdCoding::published)) {
      sound = readPublished();
    } else if (coding == static_cast<unsigned>(IdCoding::bitstring)) {
      sound = readBitstring();
    } else if (coding == static_cast<unsigned>(IdCoding::adaptive)) {
      sound = readAdaptive();
    }
    if (!sound || applied_ != count_) return fail("a message of splits is damaged");
    return applied_;
  }

 private:
  bool split(NodeIndex node) {
    if (applied_ == count_ || !mesh_.isActive(node) || mesh_.isLeaf(node) || mesh_.isVirtual(node))
      return false;
    const uint64_t begin = records_.position();
    const Record record = readRecord(records_, mesh_.base().tables, mesh_.level(node));
    if (records_.overrun()) return false;
    if (criteria_) {
      const NodeIndex parent = mesh_.parent(node);
      const NodeCriterion before = parent == kNone || parent >= session_.criteria.size()
                                       ? NodeCriterion()
                                       : session_.criteria[parent];
      if (session_.criteria.size() <= node) session_.criteria.resize(size_t{node} + 1);
      session_.criteria[node] = NodeCriterion::read(records_, before);
      if (records_.overrun()) return false;
    }
    if (!mesh_.split(node, message_, begin, record.cutEnd)) return false;
    ++applied_;
    return true;
  }

  bool readPublished() {
    BitReader in(ids_);
    const auto treeBits = static_cast<unsigned>(std::bit_width(mesh_.base().treeCount()));
    while (applied_ < count_) {
      NodeId id;
      id.tree = static_cast<uint32_t>(in.read(treeBits));
      id.depth = static_cast<uint8_t>(in.read(6));
      const unsigned upper = id.depth > 32 ? 32 : id.depth;
      if (upper > 0) id.path = in.read(upper) << (64 - upper);
      if (id.depth > upper) id.path |= in.read(id.depth - upper) << (64 - id.depth);
      if (in.overrun()) return false;
      const auto node = mesh_.find(id);
      if (!node || !split(*node)) return false;
    }
    return true;
  }

  bool readBitstring() {
    BitReader in(ids_);
    const auto tops = readTreeBitstring(in, count_);
    if (!tops) return false;
    for (const NodeId& top : *tops) {
      const auto node = mesh_.find(top);
      if (!node || !split(*node) || !readFollowing(in, *node)) return false;
    }
    return true;
  }
  bool readFollowing(BitReader& in, NodeIndex node) {
    const NodeIndex left = mesh_.leftChild(node);
    for (const NodeIndex child : {left, left + 1}) {
      if (mesh_.isLeaf(child) || !in.readBit()) continue;
      if (in.overrun() || !split(child) || !readFollowing(in, child)) return false;
    }
    return true;
  }

  bool readAdaptive() {
    AdaptiveBitReader in(ids_);
    const auto roots = static_cast<NodeIndex>(mesh_.base().roots.size());
    for (NodeIndex root = 0; root < roots; ++root) {
      if (mesh_.isLeaf(root)) continue;
      const bool isSplit = mesh_.leftChild(root) != kNone;
      if (!in.read(session_.chances.of(isSplit ? IdChances::Child::split : IdChances::Child::active,
                                       IdChances::Sibling::none, mesh_.level(root))))
        continue;
      if ((!isSplit && !split(root)) || !walk(in, root, !isSplit)) return false;
    }
    return true;
  }
  bool walk(AdaptiveBitReader& in, NodeIndex node, bool inBatch) {
    auto sibling = IdChances::Sibling::none;
    const NodeIndex left = mesh_.leftChild(node);
    for (const NodeIndex child : {left, left + 1}) {
      if (mesh_.isLeaf(child)) continue;
      const bool isSplit = !inBatch && mesh_.leftChild(child) != kNone;
      const auto kind = inBatch   ? IdChances::Child::born
                        : isSplit ? IdChances::Child::split
                                  : IdChances::Child::active;
      const bool known = !inBatch && child != left &&
                         (mesh_.isLeaf(left) || sibling == IdChances::Sibling::without);
      const bool any = known || in.read(session_.chances.of(kind, sibling, mesh_.level(child)));
      sibling = any ? IdChances::Sibling::with : IdChances::Sibling::without;
      if (!any) continue;
      if ((!isSplit && !split(child)) || !walk(in, child, !isSplit)) return false;
    }
    return true;
  }

  std::span<const uint8_t> message_;
  SelectivelyRefinedMesh& mesh_;
  ClientSession& session_;
  std::span<const uint8_t> ids_;
  BitReader records_;
  bool criteria_ = false;
  uint64_t count_ = 0;
  uint64_t applied_ = 0;
};

void writeSplitFlags(AdaptiveBitWriter& out, IdChances& chances, const SelectivelyRefinedMesh& mesh,
                     NodeIndex node) {
  if (mesh.isLeaf(node)) return;
  const NodeIndex left = mesh.leftChild(node);
  out.write(left != kNone,
            chances.of(IdChances::Child::split, IdChances::Sibling::none, mesh.level(node)));
  if (left == kNone) return;
  writeSplitFlags(out, chances, mesh, left);
  writeSplitFlags(out, chances, mesh, left + 1);
}

}  // namespace

Result<uint64_t> applySplitMessage(std::span<const uint8_t> message, SelectivelyRefinedMesh& mesh,
                                   ClientSession& session) {
  return MessageApplication(message, mesh, session).apply();
}

std::vector<uint8_t> encodeLeafList(const SelectivelyRefinedMesh& mesh) {
  std::vector<uint8_t> bytes;
  AdaptiveBitWriter out(bytes);
  IdChances chances;
  for (NodeIndex root = 0; root < mesh.base().roots.size(); ++root)
    writeSplitFlags(out, chances, mesh, root);
  out.finish();
  return bytes;
}

}  // namespace meshfront::evaluation
