// What the fronts of one or several meshes are worth: truly selective refinement (Kim, Lee and
// Kobbelt 2004) under a budget of triangles and one of bytes.
//
//   FrontBudget budget(limits);
//   budget.look(meshesInView, view, 2000);       // fresh pixel counts
//   while (budget.work(1000).more) { ... }       // in between, other things
//   apply(records, budget.splitsAllowed());      // from whoever brings new ones
//
// Of what is kept, all that a pixel asks for is split again, best rank first (significance level,
// then pixels, as shared/receiver/ranking.h), and what no pixel asks for stays as it is while
// nobody needs its room: it is likely wanted again. Where a budget is used up,
//  - what is split although it covers no pixel is collapsed first, the finest first;
//  - then what ranks last, if what wants its place clearly ranks before it: by its level, or by
//    twice the pixels at the same level;
//  - records and nodes below the front are forgotten, those first that were split last the longest
//    ago.
// A node collapses at most once while the view stays the same, so that a still view comes to rest,
// whatever the pixel counts do when the mesh changes.
//
// Both budgets hold after each single step. Bytes are those of SelectivelyRefinedMesh::bytes(),
// which grow and never shrink: a byte budget below what is held already stops the growth. While an
// array of less than 1 MiB grows, its old copy is held for that moment besides.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/refinement/selectively_refined_mesh.h"

namespace meshfront {

struct FrontLimits {
  uint64_t triangles = UINT64_MAX;  // drawn ones, of all meshes
  uint64_t bytes = UINT64_MAX;      // of all meshes and their drawers
  // With more than this share of the vertices without a pixel, such are collapsed although the
  // budgets have room. 1: never.
  double unneededShare = 1;
};

struct MeshInView {
  SelectivelyRefinedMesh* mesh = nullptr;
  std::span<const uint32_t> pixels;  // by vertex slot, of what was drawn; slots beyond count 0
  // MeshUpdate::changeCount of what was drawn. Vertices that came later are left as they are.
  uint64_t countedAt = 0;
};

struct FrontOutcome {
  uint64_t collapses = 0;
  uint64_t resplits = 0;
  uint64_t damaged = 0;  // kept records that did not apply; they are dropped
  // By mesh: the nodes that are not known any more, to be asked for anew.
  std::vector<std::vector<NodeId>> forgotten;
  // There is more to do for the counts of the last look().
  bool more = false;
};

class FrontBudget {
 public:
  explicit FrontBudget(const FrontLimits& limits) : limits_(limits) {}
  [[nodiscard]] const FrontLimits& limits() const { return limits_; }

  // Plans by fresh counts; O(vertices) of the fronts. The meshes stay where they are, in the same
  // order, until the next call; nobody else collapses or forgets anything in them. `view`: a number
  // that changes with the picture (cameras, transforms). `newRecords`: how many records that are
  // not kept may come before the next look, those under way included; room is made and held for
  // them as far as they rank. Visible nodes without a record are what they are for.
  void look(std::span<const MeshInView> meshes, uint64_t view, size_t newRecords);
  // Works off the plan: at most that many splits and collapses. O(1) each, but for forgetting,
  // which looks at all nodes once for every sixteenth of them.
  FrontOutcome work(size_t maxOperations);

  // How many records that are not kept may be split now, in whichever of the meshes. A record that
  // comes when it is 0 is kept instead (SelectivelyRefinedMesh::keepRecord).
  [[nodiscard]] uint64_t splitsAllowed() const;
  [[nodiscard]] uint64_t triangles() const;  // drawn now
  [[nodiscard]] uint64_t bytes() const;      // held now
  // Vertices of the last look() that a pixel asks for, and those that none asks for.
  [[nodiscard]] uint64_t neededVertices() const { return needed_; }
  [[nodiscard]] uint64_t unneededVertices() const { return unneeded_; }

 private:
  struct Ranked {
    uint64_t key = 0;  // level, then pixels; smaller is better
    NodeIndex node = kNone;
    uint32_t mesh = 0;
    bool kept = false;  // it has a record
  };
  struct Leaving {
    std::vector<Ranked> nodes;  // the last to be kept first
    size_t next = 0;
  };
  enum class Room { enough, needsNodes, needsSlots, needsTriangles };

  void lookAt(uint32_t number, const MeshInView& view);
  void startRound(uint64_t view);
  [[nodiscard]] bool mayLeave(const SelectivelyRefinedMesh& mesh, NodeIndex node) const;
  // For one more split in a mesh beside the `held_` ones; `newNodes`: its children are not known.
  [[nodiscard]] Room roomFor(uint32_t mesh, bool newNodes) const;
  [[nodiscard]] bool fits(uint32_t mesh, size_t splits, size_t newRecords) const;
  bool makeRoom(const Ranked& candidate, size_t& operations, FrontOutcome& outcome);
  // The one to be kept last, of one mesh or of all; null if none is left.
  Leaving* lastKept(uint32_t mesh, bool ofAll);
  void collapseNext(Leaving& leaving, FrontOutcome& outcome);
  bool forgetOldest(uint32_t mesh, FrontOutcome& outcome);
  void resplit(const Ranked& candidate, FrontOutcome& outcome);
  void keepLimits(size_t& operations, FrontOutcome& outcome);
  void enterBest(size_t& operations, FrontOutcome& outcome);
  void collapseUnneeded(size_t& operations, FrontOutcome& outcome);

  FrontLimits limits_;
  std::vector<SelectivelyRefinedMesh*> meshes_;
  std::vector<Ranked> entering_;  // best first, from nextEntering_ on
  size_t nextEntering_ = 0;
  std::vector<Ranked> unkept_;    // while looking: those without a record
  std::vector<Leaving> leaving_;  // by mesh
  size_t held_ = 0;               // room for so many new records is not given away
  uint64_t needed_ = 0;
  uint64_t unneeded_ = 0;
  // Marks of nodes: the round in which they were collapsed last; 0: never.
  uint16_t round_ = 0;
  uint16_t viewBegan_ = 1;
  std::optional<uint64_t> view_;
  std::vector<NodeIndex> oldest_;  // working space of forgetOldest()
};

}  // namespace meshfront
