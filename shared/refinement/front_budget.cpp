#include "shared/refinement/front_budget.h"

#include <algorithm>

namespace meshfront {
namespace {

constexpr size_t kPlanned = size_t{1} << 15;      // candidates of a kind that a look remembers
constexpr size_t kMostAllowed = size_t{1} << 20;  // splits that splitsAllowed() counts up to
constexpr size_t kForgottenShare = 16;            // of what can be forgotten, at a time
constexpr uint64_t kUnneeded = uint64_t{1} << 63;
constexpr uint64_t kNoPixels = UINT32_MAX;

// Smaller is better.
uint64_t rankKey(unsigned level, uint32_t pixels) {
  return uint64_t{level} << 32 | (UINT32_MAX - pixels);
}
uint64_t levelOfKey(uint64_t key) {
  return (key & ~kUnneeded) >> 32;
}
uint64_t pixelsOfKey(uint64_t key) {
  return UINT32_MAX - (key & UINT32_MAX);
}

// Whether what wants in ranks so far before what would have to go that pixels which change a
// little do not turn it round.
bool clearlyOutranks(uint64_t entering, uint64_t leaving) {
  if ((leaving & kUnneeded) != 0) return true;
  if (levelOfKey(entering) != levelOfKey(leaving))
    return levelOfKey(entering) < levelOfKey(leaving);
  return pixelsOfKey(entering) >= 2 * pixelsOfKey(leaving);
}

template <typename Items, typename Before>
void keepBest(Items& items, size_t count, const Before& before) {
  if (count < items.size()) {
    std::nth_element(items.begin(), items.begin() + static_cast<ptrdiff_t>(count), items.end(),
                     before);
    items.resize(count);
  }
  std::sort(items.begin(), items.end(), before);
}

}  // namespace

// --- looking -------------------------------------------------------------------------------------

void FrontBudget::look(std::span<const MeshInView> meshes, uint64_t view, size_t newRecords) {
  meshes_.clear();
  for (const MeshInView& mesh : meshes) meshes_.push_back(mesh.mesh);
  startRound(view);
  needed_ = unneeded_ = 0;
  held_ = nextEntering_ = 0;
  entering_.clear();
  unkept_.clear();
  leaving_.resize(meshes.size());
  const auto before = [](const Ranked& a, const Ranked& b) {
    if (a.key != b.key) return a.key < b.key;
    return a.mesh != b.mesh ? a.mesh < b.mesh : a.node < b.node;
  };
  for (uint32_t number = 0; number < meshes.size(); ++number) {
    Leaving& leaving = leaving_[number];
    leaving.nodes.clear();
    leaving.next = 0;
    lookAt(number, meshes[number]);
    keepBest(leaving.nodes, kPlanned,
             [&](const Ranked& a, const Ranked& b) { return before(b, a); });
  }
  keepBest(entering_, kPlanned, before);
  keepBest(unkept_, newRecords, before);
  const auto kept = static_cast<ptrdiff_t>(entering_.size());
  entering_.insert(entering_.end(), unkept_.begin(), unkept_.end());
  std::inplace_merge(entering_.begin(), entering_.begin() + kept, entering_.end(), before);
}

void FrontBudget::lookAt(uint32_t number, const MeshInView& view) {
  const SelectivelyRefinedMesh& mesh = *view.mesh;
  const auto counted = static_cast<uint32_t>(view.countedAt);
  const auto isCounted = [&](VertexSlot slot) {
    return static_cast<int32_t>(mesh.occupiedSince(slot) - counted) <= 0;
  };
  const auto pixelsAt = [&](VertexSlot slot) {
    return slot < view.pixels.size() ? view.pixels[slot] : 0U;
  };
  const size_t slots = mesh.vertexSlotCount();
  for (VertexSlot slot = 0; slot < slots; ++slot) {
    const NodeIndex node = mesh.nodeAt(slot);
    if (node == kNone || mesh.isVirtual(node) || !isCounted(slot)) continue;
    const uint32_t pixels = pixelsAt(slot);
    ++(pixels > 0 ? needed_ : unneeded_);
    if (pixels > 0 && !mesh.isLeaf(node)) {
      const bool kept = mesh.hasRecord(node);
      (kept ? entering_ : unkept_)
          .push_back({rankKey(mesh.level(node), pixels), node, number, kept});
    }
    // Each split is met at its right child.
    const NodeIndex parent = mesh.parent(node);
    if (parent == kNone || mesh.leftChild(parent) == node || !mesh.isActive(node - 1)) continue;
    const VertexSlot left = mesh.slot(node - 1);
    if (!isCounted(left) || !mayLeave(mesh, parent)) continue;
    const uint64_t both = std::min(uint64_t{pixels} + pixelsAt(left), kNoPixels);
    leaving_[number].nodes.push_back(
        {rankKey(mesh.level(parent), static_cast<uint32_t>(both)) | (both == 0 ? kUnneeded : 0),
         parent, number, true});
  }
}

void FrontBudget::startRound(uint64_t view) {
  if (round_ == UINT16_MAX) {
    // Half as fine: what is older stays older, or becomes as old.
    for (SelectivelyRefinedMesh* mesh : meshes_)
      for (NodeIndex node = 0; node < mesh->nodeCount(); ++node)
        mesh->setMark(node, mesh->mark(node) / 2);
    round_ /= 2;
    viewBegan_ = std::max<uint16_t>(viewBegan_ / 2, 1);
  }
  ++round_;
  if (view_ == view) return;
  view_ = view;
  viewBegan_ = round_;
}

// Once a view; and not while requests for its children are under way.
bool FrontBudget::mayLeave(const SelectivelyRefinedMesh& mesh, NodeIndex node) const {
  const NodeIndex left = mesh.leftChild(node);
  return mesh.mark(node) < viewBegan_ && !mesh.isPinned(left) && !mesh.isPinned(left + 1);
}

// --- budgets -------------------------------------------------------------------------------------

uint64_t FrontBudget::triangles() const {
  uint64_t sum = 0;
  for (const SelectivelyRefinedMesh* mesh : meshes_) sum += mesh->drawnTriangleCount();
  return sum;
}

uint64_t FrontBudget::bytes() const {
  uint64_t sum = 0;
  for (const SelectivelyRefinedMesh* mesh : meshes_) sum += mesh->bytes();
  return sum;
}

// Whether the bytes suffice for that many splits in one mesh beside `held_` ones, wherever those
// are. What was more than the limit before may stay.
bool FrontBudget::fits(uint32_t mesh, size_t splits, size_t newRecords) const {
  if (limits_.bytes == UINT64_MAX) return true;
  uint64_t sum = 0;
  for (uint32_t number = 0; number < meshes_.size(); ++number)
    sum += number == mesh ? meshes_[number]->bytesAfter(held_ + splits, held_ + newRecords)
                          : meshes_[number]->bytesAfter(held_, held_);
  return sum <= limits_.bytes || sum == bytes();
}

FrontBudget::Room FrontBudget::roomFor(uint32_t mesh, bool newNodes) const {
  if (triangles() + 2 * (held_ + 1) > limits_.triangles) return Room::needsTriangles;
  if (fits(mesh, 1, newNodes ? 1 : 0)) return Room::enough;
  return newNodes && fits(mesh, 1, 0) ? Room::needsNodes : Room::needsSlots;
}

uint64_t FrontBudget::splitsAllowed() const {
  const uint64_t drawn = triangles();
  if (drawn >= limits_.triangles) return 0;
  uint64_t most = std::min<uint64_t>((limits_.triangles - drawn) / 2, kMostAllowed);
  if (limits_.bytes == UINT64_MAX) return most;
  const uint64_t now = bytes();
  const auto holds = [&](uint64_t splits) {
    uint64_t sum = 0;
    for (const SelectivelyRefinedMesh* mesh : meshes_) sum += mesh->bytesAfter(splits, splits);
    return sum <= limits_.bytes || sum == now;
  };
  uint64_t least = 0;  // the largest number that holds
  while (least < most) {
    const uint64_t middle = least + (most - least + 1) / 2;
    if (holds(middle)) {
      least = middle;
    } else {
      most = middle - 1;
    }
  }
  return least;
}

// --- working -------------------------------------------------------------------------------------

FrontOutcome FrontBudget::work(size_t maxOperations) {
  FrontOutcome outcome;
  outcome.forgotten.resize(meshes_.size());
  size_t operations = maxOperations;
  keepLimits(operations, outcome);
  enterBest(operations, outcome);
  collapseUnneeded(operations, outcome);
  outcome.more = operations == 0;
  return outcome;
}

void FrontBudget::keepLimits(size_t& operations, FrontOutcome& outcome) {
  while (operations > 0 && triangles() > limits_.triangles) {
    Leaving* leaving = lastKept(0, true);
    if (leaving == nullptr) return;
    collapseNext(*leaving, outcome);
    --operations;
  }
}

void FrontBudget::enterBest(size_t& operations, FrontOutcome& outcome) {
  while (operations > 0 && nextEntering_ < entering_.size()) {
    const Ranked& candidate = entering_[nextEntering_];
    const SelectivelyRefinedMesh& mesh = *meshes_[candidate.mesh];
    if (!mesh.isActive(candidate.node) || mesh.hasRecord(candidate.node) != candidate.kept) {
      ++nextEntering_;
      continue;
    }
    if (!makeRoom(candidate, operations, outcome)) {
      if (operations == 0) return;  // it is its turn again
    } else if (!candidate.kept) {
      ++held_;
    } else {
      if (operations == 0) return;
      resplit(candidate, outcome);
      --operations;
    }
    ++nextEntering_;
  }
}

bool FrontBudget::makeRoom(const Ranked& candidate, size_t& operations, FrontOutcome& outcome) {
  const bool newNodes = meshes_[candidate.mesh]->leftChild(candidate.node) == kNone;
  while (true) {
    const Room room = roomFor(candidate.mesh, newNodes);
    if (room == Room::enough) return true;
    if (operations == 0) return false;
    if (room == Room::needsNodes && forgetOldest(candidate.mesh, outcome)) {
      --operations;
      continue;
    }
    // Slots and nodes are of use to their own mesh alone.
    Leaving* leaving = lastKept(candidate.mesh, room == Room::needsTriangles);
    if (leaving == nullptr || !clearlyOutranks(candidate.key, leaving->nodes[leaving->next].key)) {
      // Triangles are short for all that rank behind it too.
      if (room == Room::needsTriangles) nextEntering_ = entering_.size() - 1;
      return false;
    }
    const Ranked& last = leaving->nodes[leaving->next];
    if (last.mesh == candidate.mesh && meshes_[last.mesh]->parent(candidate.node) == last.node) {
      ++leaving->next;  // it would go with it
      continue;
    }
    collapseNext(*leaving, outcome);
    --operations;
  }
}

FrontBudget::Leaving* FrontBudget::lastKept(uint32_t mesh, bool ofAll) {
  Leaving* last = nullptr;
  for (uint32_t number = 0; number < leaving_.size(); ++number) {
    if (!ofAll && number != mesh) continue;
    Leaving& leaving = leaving_[number];
    while (leaving.next < leaving.nodes.size() &&
           (!meshes_[number]->canCollapse(leaving.nodes[leaving.next].node) ||
            !mayLeave(*meshes_[number], leaving.nodes[leaving.next].node)))
      ++leaving.next;
    if (leaving.next == leaving.nodes.size()) continue;
    if (last == nullptr || leaving.nodes[leaving.next].key > last->nodes[last->next].key)
      last = &leaving;
  }
  return last;
}

void FrontBudget::collapseNext(Leaving& leaving, FrontOutcome& outcome) {
  const Ranked& node = leaving.nodes[leaving.next++];
  SelectivelyRefinedMesh& mesh = *meshes_[node.mesh];
  mesh.collapse(node.node);
  mesh.setMark(node.node, round_);
  if ((node.key & kUnneeded) != 0 && unneeded_ > 0) --unneeded_;
  ++outcome.collapses;
}

void FrontBudget::resplit(const Ranked& candidate, FrontOutcome& outcome) {
  SelectivelyRefinedMesh& mesh = *meshes_[candidate.mesh];
  if (mesh.resplit(candidate.node)) {
    ++outcome.resplits;
    return;
  }
  mesh.dropRecord(candidate.node, &outcome.forgotten[candidate.mesh]);
  ++outcome.damaged;
}

// Nodes whose children were split last the longest ago, and have none of their own.
bool FrontBudget::forgetOldest(uint32_t number, FrontOutcome& outcome) {
  SelectivelyRefinedMesh& mesh = *meshes_[number];
  oldest_.clear();
  for (NodeIndex node = 0; node < mesh.nodeCount(); ++node) {
    const NodeIndex left = mesh.leftChild(node);
    if (left == kNone || mesh.isSplit(node) || mesh.leftChild(left) != kNone ||
        mesh.leftChild(left + 1) != kNone || mesh.isPinned(left) || mesh.isPinned(left + 1))
      continue;
    oldest_.push_back(node);
  }
  if (oldest_.empty()) return false;
  const size_t count = oldest_.size() / kForgottenShare + 1;
  const auto older = [&](NodeIndex a, NodeIndex b) {
    return mesh.mark(a) != mesh.mark(b) ? mesh.mark(a) < mesh.mark(b) : a < b;
  };
  keepBest(oldest_, count, older);
  for (const NodeIndex node : oldest_) mesh.forgetBelow(node, &outcome.forgotten[number]);
  return true;
}

void FrontBudget::collapseUnneeded(size_t& operations, FrontOutcome& outcome) {
  while (operations > 0 && static_cast<double>(unneeded_) >
                               limits_.unneededShare * static_cast<double>(needed_ + unneeded_)) {
    Leaving* leaving = lastKept(0, true);
    if (leaving == nullptr || (leaving->nodes[leaving->next].key & kUnneeded) == 0) return;
    collapseNext(*leaving, outcome);
    --operations;
  }
}

}  // namespace meshfront
