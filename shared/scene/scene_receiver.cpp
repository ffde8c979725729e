#include "shared/scene/scene_receiver.h"

#include <algorithm>
#include <glm/matrix.hpp>
#include <utility>

#include "shared/receiver/ranking.h"
#include "shared/scene/likely_error.h"
#include "shared/scene/mesh_placement.h"
#include "shared/scene/seen_rim.h"

namespace meshfront {
namespace {

constexpr size_t kBudgetOperations = 5'000;  // collapses and splits at a time: some milliseconds
// The rim may come along when no more than one of so many pixels is still open.
constexpr uint64_t kOpenBesideRim = 8;

// The worst of two states is the scene's.
int rankOf(ReceiverState state) {
  switch (state) {
    case ReceiverState::complete:
      return 0;
    case ReceiverState::settled:
      return 1;
    case ReceiverState::limitReached:
      return 2;
    case ReceiverState::refining:
      return 3;
    case ReceiverState::connecting:
      return 4;
    case ReceiverState::degraded:
      return 5;
  }
  return 5;
}

void add(ReceiverStatistics& sum, const ReceiverStatistics& one) {
  sum.requests += one.requests;
  sum.answers += one.answers;
  sum.records += one.records;
  sum.recordsFromDisk += one.recordsFromDisk;
  sum.malformed += one.malformed;
  sum.cancelled += one.cancelled;
  sum.expanded += one.expanded;
  sum.answersFromCaches += one.answersFromCaches;
  sum.idsRequested += one.idsRequested;
  sum.setOctets += one.setOctets;
  sum.requestBytesUp += one.requestBytesUp;
  sum.answerBytesDown += one.answerBytesDown;
  sum.traffic += one.traffic;
}

// A point of the world in a mesh's grid steps.
glm::dvec3 onGrid(const glm::dvec3& world, const SceneMesh& mesh, const Quantization& grid) {
  const glm::dvec3 point(glm::inverse(mesh.worldFromMesh) * glm::dvec4(world, 1));
  return (point - glm::dvec3(grid.origin[0], grid.origin[1], grid.origin[2])) / grid.step;
}

}  // namespace

SceneReceiver::SceneReceiver(std::vector<SceneMesh> meshes, const SceneOptions& options,
                             Transport& transport)
    : options_(options), budget_(options.limits) {
  for (SceneMesh& placed : meshes) {
    MeshOfScene& mesh = meshes_.emplace_back();
    mesh.placed = std::move(placed);
    mesh.receiver = std::make_unique<Receiver>(mesh.placed.url, options.receiver, transport);
  }
}

SceneReceiver::~SceneReceiver() = default;

std::optional<Bounds> SceneReceiver::bounds() const {
  std::optional<Bounds> all;
  for (const MeshOfScene& mesh : meshes_) {
    const MeshMetadata* metadata = mesh.receiver->metadata();
    if (metadata == nullptr) continue;
    const Bounds world = movedBounds(Bounds::of(metadata->boundsMin, metadata->boundsMax),
                                     mesh.placed.worldFromMesh);
    all = all ? unitedBounds(*all, world) : world;
  }
  return all;
}

bool SceneReceiver::isAtWork() const {
  return budgetHasMore_ || std::any_of(meshes_.begin(), meshes_.end(), [](const MeshOfScene& mesh) {
           return mesh.receiver->isAtWork();
         });
}

bool SceneReceiver::allHere() const {
  return std::all_of(meshes_.begin(), meshes_.end(),
                     [](const MeshOfScene& mesh) { return mesh.receiver->mesh() != nullptr; });
}

bool SceneReceiver::waitForArrival(std::chrono::milliseconds timeout) const {
  // One mesh, the usual case, waits by itself; several are looked at in turn.
  if (meshes_.size() == 1) return meshes_.front().receiver->waitForArrival(timeout);
  const auto until = std::chrono::steady_clock::now() + timeout;
  do {
    for (const MeshOfScene& mesh : meshes_)
      if (mesh.receiver->waitForArrival(std::chrono::milliseconds(1))) return true;
  } while (std::chrono::steady_clock::now() < until);
  return false;
}

bool SceneReceiver::advance(size_t maxSplits) {
  bool finished = false;
  if (budgetHasMore_) workBudgets();
  for (size_t i = 0; i < meshes_.size(); ++i) {
    Receiver& receiver = *meshes_[(next_ + i) % meshes_.size()].receiver;
    // The budgets are of all: what one has used the next one lacks.
    if (hasBudgets() && receiver.mesh() != nullptr && !budgeted_.empty())
      receiver.setSplitAllowance(budget_.splitsAllowed());
    const uint64_t before = receiver.statistics().records;
    finished = receiver.advance(maxSplits) || finished;
    maxSplits -= std::min<uint64_t>(maxSplits, receiver.statistics().records - before);
  }
  next_ = (next_ + 1) % meshes_.size();
  return finished;
}

bool SceneReceiver::wantsRanking() const {
  return std::any_of(meshes_.begin(), meshes_.end(),
                     [](const MeshOfScene& mesh) { return mesh.receiver->wantsRanking(); });
}

std::vector<MeshNews> SceneReceiver::takeNews() {
  std::vector<MeshNews> news;
  for (size_t i = 0; i < meshes_.size(); ++i) {
    MeshOfScene& mesh = meshes_[i];
    SelectivelyRefinedMesh* front = mesh.receiver->meshToRefine();
    if (front == nullptr || (mesh.introduced && front->changeCount() == mesh.told)) continue;
    MeshNews& one = news.emplace_back();
    one.mesh = i;
    if (!mesh.introduced) {
      one.introduced = *mesh.receiver->metadata();
      one.coloured = front->attributeLayout().colours;
      mesh.introduced = true;
    }
    one.update = front->takeUpdate();
    mesh.told = front->changeCount();
    if (!one.update.born.empty()) mesh.births.push_back({one.update.changeCount, one.update.born});
  }
  return news;
}

uint64_t SceneReceiver::changesUntold() const {
  uint64_t changes = 0;
  for (const MeshOfScene& mesh : meshes_)
    if (const auto* front = mesh.receiver->mesh()) changes += front->changeCount() - mesh.told;
  return changes;
}

// --- ranking -------------------------------------------------------------------------------------

void SceneReceiver::rank(const SceneCounts& counts) {
  if (counts.ahead) {
    rankAhead(counts);
    return;
  }
  SeenPixels seen = takePixels(counts);
  const bool withRim = addRims(seen, counts);
  if (hasBudgets()) {
    const uint64_t before = changeCount();
    planBudgets(counts);
    if (changeCount() != before) {
      seen = takePixels(counts);
      if (withRim) (void)addRims(seen, counts);
    }
  }
  finalShare_ =
      seen.all == 0 ? 0 : 1 - static_cast<double>(seen.open) / static_cast<double>(seen.all);
  liftAll(counts);
  compareSizes(counts.camera);
  shareOut();
  for (MeshOfScene& mesh : meshes_) {
    if (mesh.receiver->mesh() == nullptr) continue;
    if (hasBudgets()) mesh.receiver->setSplitAllowance(budget_.splitsAllowed());
    mesh.receiver->rank(mesh.pixels, {mesh.lift, mesh.levelsBehind, mesh.share, hasBudgets()});
  }
}

// Brings all counts up to date.
SeenPixels SceneReceiver::takePixels(const SceneCounts& counts) {
  SeenPixels sum;
  for (size_t i = 0; i < meshes_.size() && i < counts.meshes.size(); ++i) {
    MeshOfScene& mesh = meshes_[i];
    if (mesh.receiver->mesh() == nullptr) continue;
    bringUpToDate(mesh, counts.meshes[i]);
    const SeenPixels seen = seenPixels(*mesh.receiver->mesh(), mesh.pixels);
    sum.all += seen.all;
    sum.open += seen.open;
    sum.nodes += seen.nodes;
    sum.openNodes += seen.openNodes;
  }
  return sum;
}

// A pixel for each vertex of the rims: where they join what is seen, or as soon as that takes
// nothing from it, when all of it is split, or when the little that is left goes into one request
// together with the rims, so that their generations take no round trips of their own.
bool SceneReceiver::addRims(const SeenPixels& seen, const SceneCounts& counts) {
  for (MeshOfScene& mesh : meshes_) mesh.rim.clear();
  if (!options_.rim) return false;
  const bool join = rimJoins(seen) && rimsMayJoin(seen);
  if (!join && seen.open * kOpenBesideRim > seen.all) return false;
  size_t nodes = seen.openNodes;
  for (MeshOfScene& mesh : meshes_) {
    const SelectivelyRefinedMesh* front = mesh.receiver->mesh();
    if (front == nullptr) continue;
    const Quantization& grid = mesh.receiver->metadata()->quantization;
    mesh.rim = openRim(*front, mesh.pixels, onGrid(counts.camera.eye, mesh.placed, grid),
                       pixelsAtOne(counts.camera, counts.picture));
    nodes += mesh.rim.size();
  }
  if (!join && !rimsFitLast(seen, nodes)) {
    for (MeshOfScene& mesh : meshes_) mesh.rim.clear();
    return false;
  }
  for (MeshOfScene& mesh : meshes_)
    for (const VertexSlot slot : mesh.rim) mesh.pixels[slot] = 1;
  return nodes > seen.openNodes;
}

// `nodes`: what is open of rims and of what is seen. Nobody's room is taken for the rims.
bool SceneReceiver::rimsFitLast(const SeenPixels& seen, size_t nodes) const {
  if (seen.open > 0 && nodes > batchNow()) return false;
  return !hasBudgets() || budgeted_.empty() || budget_.splitsAllowed() >= nodes;
}

// Not where room may become scarce: it is that of what is seen.
bool SceneReceiver::rimsMayJoin(const SeenPixels& seen) const {
  if (!ranksByLikelyError() || options_.limits.triangles != UINT64_MAX) return false;
  if (!hasBudgets()) return true;
  uint64_t splits = 0;
  for (const MeshOfScene& mesh : meshes_)
    if (const auto* metadata = mesh.receiver->metadata()) splits += metadata->splitCount;
  // What covers so many pixels does not need more vertices.
  return !budgeted_.empty() && budget_.splitsAllowed() >= std::min(splits, seen.all / 3);
}

void SceneReceiver::liftAll(const SceneCounts& counts) {
  for (MeshOfScene& mesh : meshes_) {
    const SelectivelyRefinedMesh* front = mesh.receiver->mesh();
    if (front == nullptr) continue;
    const Quantization& grid = mesh.receiver->metadata()->quantization;
    liftOf(front->positions(), mesh.pixels, grid, mesh.placed.worldFromMesh, counts.camera,
           options_.foveation, spot_, mesh.lift);
    if (!ranksByLikelyError()) continue;
    liftByLikelyError(*front, mesh.pixels, onGrid(counts.camera.eye, mesh.placed, grid),
                      pixelsAtOne(counts.camera, counts.picture), mesh.lift);
    for (const VertexSlot slot : mesh.rim)
      mesh.lift[slot] =
          static_cast<uint8_t>(mesh.lift[slot] - std::min(mesh.lift[slot], kRimLevelsBehind));
  }
}

// --- budgets -------------------------------------------------------------------------------------

bool SceneReceiver::hasBudgets() const {
  return options_.limits.triangles != UINT64_MAX || options_.limits.bytes != UINT64_MAX ||
         options_.limits.unneededShare < 1;
}

void SceneReceiver::planBudgets(const SceneCounts& counts) {
  if (view_ == 0 || viewedFrom_ != counts.camera || viewedAt_ != counts.picture) {
    ++view_;
    viewedFrom_ = counts.camera;
    viewedAt_ = counts.picture;
  }
  std::vector<MeshInView> views;
  budgeted_.clear();
  uint64_t underWay = 0;
  for (size_t i = 0; i < meshes_.size() && i < counts.meshes.size(); ++i) {
    SelectivelyRefinedMesh* front = meshes_[i].receiver->meshToRefine();
    if (front == nullptr) continue;
    views.push_back({front, meshes_[i].pixels, counts.meshes[i].changeCount});
    budgeted_.push_back(i);
    underWay += meshes_[i].receiver->requestsUnderWay();
  }
  // Room for what is under way and for what this ranking will ask for.
  budget_.look(views, view_, batchNow() * (underWay + 2 * views.size()));
  workBudgets();
}

void SceneReceiver::workBudgets() {
  const FrontOutcome outcome = budget_.work(kBudgetOperations);
  collapses_ += outcome.collapses;
  resplits_ += outcome.resplits;
  budgetHasMore_ = outcome.more;
  for (size_t i = 0; i < outcome.forgotten.size() && i < budgeted_.size(); ++i)
    if (!outcome.forgotten[i].empty()) meshes_[budgeted_[i]].receiver->forgot(outcome.forgotten[i]);
}

// Counts may be of a mesh that has been split since: a vertex that came afterwards shows what the
// ancestor showed that was there, halved for each generation. Slots that became free cover nothing.
void SceneReceiver::bringUpToDate(MeshOfScene& mesh, const MeshCounts& counts) {
  const SelectivelyRefinedMesh& front = *mesh.receiver->mesh();
  mesh.pixels.assign(counts.pixels.begin(), counts.pixels.end());
  mesh.pixels.resize(front.vertexSlotCount(), 0);
  std::erase_if(mesh.births, [&](const Births& b) { return b.changeCount <= counts.changeCount; });
  if (front.changeCount() == counts.changeCount) return;
  newborn_.assign(mesh.pixels.size(), false);
  for (const Births& births : mesh.births)
    for (const VertexSlot slot : births.slots) newborn_[slot] = true;
  front.forEachBorn([this](VertexSlot slot) { newborn_[slot] = true; });
  for (VertexSlot slot = 0; slot < mesh.pixels.size(); ++slot)
    if (newborn_[slot] || front.nodeAt(slot) == kNone) mesh.pixels[slot] = 0;
  for (VertexSlot slot = 0; slot < mesh.pixels.size(); ++slot) {
    if (!newborn_[slot] || front.nodeAt(slot) == kNone) continue;
    // A left child stands in its parent's slot, so that the way up leads to slots ever older.
    NodeIndex node = front.nodeAt(slot);
    unsigned generations = 0;
    while (newborn_[front.slot(node)] && front.parent(node) != kNone) {
      node = front.parent(node);
      ++generations;
    }
    const uint32_t shown = newborn_[front.slot(node)] ? 0 : mesh.pixels[front.slot(node)];
    if (shown > 0) mesh.pixels[slot] = std::max(1U, shown >> std::min(generations, 31U));
  }
}

// A mesh that looks smaller comes later by the levels that it would take one of full size to look
// as fine.
void SceneReceiver::compareSizes(const Camera& camera) {
  double largest = 0;
  for (MeshOfScene& mesh : meshes_) {
    if (mesh.receiver->mesh() == nullptr) continue;
    const MeshMetadata& metadata = *mesh.receiver->metadata();
    mesh.apparentSize = apparentSize(
        movedBounds(Bounds::of(metadata.boundsMin, metadata.boundsMax), mesh.placed.worldFromMesh),
        camera.eye);
    largest = std::max(largest, mesh.apparentSize);
  }
  // Room in front of the levels for what is lifted.
  const unsigned room = ranksByLikelyError() ? kMostErrorLift : 0;
  for (MeshOfScene& mesh : meshes_)
    mesh.levelsBehind = levelsBehind(mesh.apparentSize, largest) + room;
}

// Records of a request.
size_t SceneReceiver::batchNow() const {
  if (options_.receiver.batch > 0) return options_.receiver.batch;
  uint64_t splits = 0;
  for (const MeshOfScene& mesh : meshes_)
    if (const auto* front = mesh.receiver->mesh()) splits += front->splitsApplied();
  return adaptiveBatch(splits);
}

// How many of the records that the next requests ask for are each mesh's: those of its vertices
// that are among the first of all.
void SceneReceiver::shareOut() {
  if (meshes_.size() == 1) {
    meshes_.front().share = SIZE_MAX;
    return;
  }
  std::vector<Candidate> all;  // slot: the mesh
  for (size_t i = 0; i < meshes_.size(); ++i) {
    MeshOfScene& mesh = meshes_[i];
    mesh.share = 0;
    const SelectivelyRefinedMesh* front = mesh.receiver->mesh();
    if (front == nullptr) continue;
    for (Candidate& candidate :
         visibleCandidates(*front, mesh.pixels, {}, {mesh.lift, mesh.levelsBehind})) {
      if (front->hasRecord(candidate.node)) continue;
      candidate.slot = static_cast<VertexSlot>(i);
      all.push_back(candidate);
    }
  }
  keepFirst(all, batchNow() * windowOf(options_.receiver), options_.receiver.order);
  for (const Candidate& candidate : all) ++meshes_[candidate.slot].share;
}

void SceneReceiver::rankAhead(const SceneCounts& counts) {
  for (size_t i = 0; i < meshes_.size() && i < counts.meshes.size(); ++i) {
    const SelectivelyRefinedMesh* front = meshes_[i].receiver->mesh();
    // Those that lag would name other vertices; there will be others.
    if (front != nullptr && front->changeCount() == counts.meshes[i].changeCount)
      meshes_[i].receiver->rankAhead(counts.meshes[i].pixels);
  }
}

void SceneReceiver::tendLost(AutomaticResume::Clock::time_point now) {
  for (MeshOfScene& mesh : meshes_) (void)mesh.resume.tend(*mesh.receiver, now);
}

std::optional<std::chrono::milliseconds> SceneReceiver::nextResumeAfter(
    AutomaticResume::Clock::time_point now) const {
  std::optional<std::chrono::milliseconds> soonest;
  for (const MeshOfScene& mesh : meshes_) {
    if (mesh.receiver->state() != ReceiverState::degraded) continue;
    const auto after = mesh.resume.nextResumeAfter(now);
    if (after && (!soonest || *after < *soonest)) soonest = after;
  }
  return soonest;
}

// --- numbers -------------------------------------------------------------------------------------

uint64_t SceneReceiver::changeCount() const {
  uint64_t changes = 0;
  for (const MeshOfScene& mesh : meshes_)
    if (const auto* front = mesh.receiver->mesh()) changes += front->changeCount();
  return changes;
}

SceneStatus SceneReceiver::status() const {
  SceneStatus status;
  status.state = ReceiverState::complete;
  for (const MeshOfScene& mesh : meshes_) {
    const Receiver& receiver = *mesh.receiver;
    MeshProgress& one = status.meshes.emplace_back();
    one.name = mesh.placed.name;
    one.state = receiver.state();
    one.reason = receiver.reason();
    if (const SelectivelyRefinedMesh* front = receiver.mesh()) {
      one.revision = receiver.metadata()->revision;
      one.triangles = front->drawnTriangleCount();
      one.trianglesOfMesh = receiver.metadata()->triangleCount;
      one.splits = front->splitsApplied();
      one.splitCount = front->splitCount();
      one.recordsHeld = front->recordsHeld();
      status.cpuBytes += front->memoryBytes();
      status.gpuBytes += front->drawerBytes();
    }
    if (rankOf(one.state) > rankOf(status.state)) {
      status.state = one.state;
      status.reason =
          one.reason.empty() || meshes_.size() == 1 ? one.reason : one.name + ": " + one.reason;
    }
    status.offline =
        status.offline || (one.state == ReceiverState::degraded &&
                           !options_.receiver.cacheFolder.empty() && receiver.mesh() != nullptr);
    status.triangles += one.triangles;
    status.trianglesOfMesh += one.trianglesOfMesh;
    status.splits += one.splits;
    status.splitCount += one.splitCount;
    status.recordsHeld += one.recordsHeld;
    status.requestsUnderWay += receiver.requestsUnderWay();
    status.visibleCandidates += receiver.visibleCandidateCount();
    add(status.statistics, receiver.statistics());
    const auto roundTrip = receiver.link().roundTrip();
    if (roundTrip) {
      const double seconds = std::chrono::duration<double>(*roundTrip).count();
      status.roundTripSeconds = std::max(status.roundTripSeconds.value_or(0), seconds);
    }
    status.bytesPerSecond += receiver.link().bytesPerSecond().value_or(0);
  }
  if (status.state == ReceiverState::settled && budgetHasMore_)
    status.state = ReceiverState::refining;
  status.collapses = collapses_;
  status.resplits = resplits_;
  status.finalShare = finalShare_;
  return status;
}

}  // namespace meshfront
