// A message of splits, from the sender to its client: IDs and records, all that one batch holds.
//
//   ways: coding of the IDs u(2), whether criteria follow each record u(1), splits eg(8), octets of
//   the IDs eg(8), zero bits up to a byte; the IDs; the records bit by bit (each with its
//   criterion, node_criterion.h), zero bits up to a byte
//
// The IDs' codings:
//  published  each by itself: tree in as many bits as the number of trees takes, depth u(6), the
//             path. Splits go in the very order of their rank.
//  bitstring  the nodes on the client's front as requests name them (tree_bitstring.h), then, in
//             preorder, for each child that has a record whether it follows too. No state at all.
//  adaptive   a walk down the hierarchy that both ends know: for each child that has a record,
//             whether something at or below it is sent; arithmetic code with chances learned over
//             the session, by level, by whether the child is on the client's front, and by its
//             sibling. The fewest bits, at the price of some computing.
// In the latter two the splits of a batch go in preorder.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/codec/code_tables.h"
#include "shared/refinement/selectively_refined_mesh.h"
#include "tests/evaluation/sender_driven/active_tags.h"
#include "tests/evaluation/sender_driven/adaptive_bits.h"
#include "tests/evaluation/sender_driven/node_criterion.h"
#include "tests/evaluation/sender_driven/sender_model.h"

namespace meshfront::evaluation {

inline constexpr unsigned kMessageCountOrder = 8;  // Exp-Golomb, of the counts in a message

enum class IdCoding : uint8_t { published, bitstring, adaptive };

// What the adaptive coding has learned; both ends of a session hold one.
class IdChances {
 public:
  enum class Child : uint8_t { split, active, born };  // born: its parent is part of the batch
  enum class Sibling : uint8_t { none, without, with };
  AdaptiveChance& of(Child child, Sibling sibling, unsigned level) {
    return chances_[(static_cast<size_t>(child) * 3 + static_cast<size_t>(sibling)) * kLevelCount +
                    level];
  }
  [[nodiscard]] size_t memoryBytes() const { return sizeof(*this); }

 private:
  std::array<AdaptiveChance, 9 * kLevelCount> chances_;
};

// A batch's IDs alone, as the second half of the header and the IDs above.
class IdWriter {
 public:
  IdWriter(const SenderModel& model, IdCoding coding) : model_(model), coding_(coding) {}
  // `nodes`: ascending, but for `published`; `sent` holds them already (adaptive only).
  [[nodiscard]] std::span<const uint8_t> write(std::span<const uint32_t> nodes,
                                               const ActiveTags* sent, IdChances& chances);
  [[nodiscard]] static unsigned publishedBits(const SenderModel& model, uint32_t node);

 private:
  void writePublished(BitWriter& out) const;
  void writeBitstring(BitWriter& out);
  // The nodes of the batch at or below `node`, at least one, lie from at_ on up to `end`.
  void writeVisit(BitWriter& out, uint32_t node, size_t end);
  // The first place from `from` on whose node is not below `end`.
  [[nodiscard]] size_t behind(size_t from, uint32_t end) const;
  void writeFollowing(BitWriter& out, uint32_t node);
  void writeAdaptive(const ActiveTags& sent, IdChances& chances);
  void walk(AdaptiveBitWriter& out, uint32_t node, bool inBatch, const ActiveTags& sent,
            IdChances& chances);
  [[nodiscard]] uint32_t nextNode() const { return at_ < nodes_.size() ? nodes_[at_] : kNoNode; }

  const SenderModel& model_;
  IdCoding coding_;
  std::span<const uint32_t> nodes_;
  size_t at_ = 0;  // of nodes_
  std::vector<uint8_t> bytes_;
};

// What a client has of a session beside its mesh.
struct ClientSession {
  IdChances chances;
  std::vector<NodeCriterion> criteria;  // by NodeIndex, where they are sent
};

// Splits what an untrusted message brings. Returns how many; on an error those in front of it have
// been split.
Result<uint64_t> applySplitMessage(std::span<const uint8_t> message, SelectivelyRefinedMesh& mesh,
                                   ClientSession& session);

// The client's front, for a server that has forgotten it: for each node that has a record, parents
// first, whether it has been split; some two bits a split and less.
[[nodiscard]] std::vector<uint8_t> encodeLeafList(const SelectivelyRefinedMesh& mesh);

}  // namespace meshfront::evaluation
