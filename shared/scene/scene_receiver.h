// Refines the meshes of a scene for one view, with one scheduler for all of them.
//
//   SceneReceiver scene(*readSceneFile(path), {}, http);
//   while (scene.isAtWork()) {
//     scene.waitForArrival(100ms);
//     scene.advance();
//     upload(scene.takeNews());
//     if (scene.wantsRanking()) scene.rank(countPixels());
//   }
//
// A ranking compares the front vertices of all meshes: by significance level, corrected for how
// large each mesh looks (mesh_placement.h), for what is likely to be wrong in the picture
// (likely_error.h) and for what is looked at (view_lift.h), then by pixels.
// The first ones are asked for, each of its own service. Budgets are of all meshes together.
// Belongs to one thread; RefinementThread gives it one. The transport must outlive it.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "shared/camera/bounds.h"
#include "shared/receiver/automatic_resume.h"
#include "shared/receiver/receiver.h"
#include "shared/refinement/front_budget.h"
#include "shared/refinement/mesh_update.h"
#include "shared/scene/mesh_news.h"
#include "shared/scene/scene_counts.h"
#include "shared/scene/scene_file.h"
#include "shared/scene/scene_status.h"
#include "shared/scene/seen_rim.h"
#include "shared/scene/view_lift.h"

namespace meshfront {

struct SceneOptions {
  ReceiverOptions receiver;  // of each mesh; its onArrival is called for all
  Foveation foveation{.on = false};
  FrontLimits limits;  // of all meshes; without any nothing is collapsed
  // The rim is split, too (seen_rim.h), so far as the limits leave room: a settled view then looks
  // more like the published mesh, and needs nothing when it comes back. It comes last; where the
  // order is by significance and there is room for all, it is ranked with what is seen as soon as
  // that is fine enough.
  bool rim = true;
};

class SceneReceiver {
 public:
  SceneReceiver(std::vector<SceneMesh> meshes, const SceneOptions& options, Transport& transport);
  ~SceneReceiver();
  SceneReceiver(const SceneReceiver&) = delete;
  SceneReceiver& operator=(const SceneReceiver&) = delete;

  [[nodiscard]] size_t meshCount() const { return meshes_.size(); }
  [[nodiscard]] const SceneMesh& mesh(size_t i) const { return meshes_[i].placed; }
  [[nodiscard]] const Receiver& receiver(size_t i) const { return *meshes_[i].receiver; }
  // World; of the meshes whose metadata is there, nullopt before the first.
  [[nodiscard]] std::optional<Bounds> bounds() const;

  [[nodiscard]] bool isAtWork() const;  // any of them
  [[nodiscard]] bool allHere() const;   // all have at least their base meshes
  [[nodiscard]] bool hasBudgets() const;
  [[nodiscard]] SceneStatus status() const;

  // As Receiver's, over all meshes.
  bool waitForArrival(std::chrono::milliseconds timeout) const;
  bool advance(size_t maxSplits = SIZE_MAX);
  [[nodiscard]] bool wantsRanking() const;
  // Counts of a view that may come (SceneCounts::ahead) are for spare bandwidth alone.
  void rank(const SceneCounts& counts);

  [[nodiscard]] uint64_t changeCount() const;  // of all meshes, summed
  // Of the meshes that have changed since the last call.
  [[nodiscard]] std::vector<MeshNews> takeNews();
  [[nodiscard]] uint64_t changesUntold() const;  // splits and collapses, of all meshes
  // Wanted first from the next ranking on; nullopt: nothing special.
  void refineFirst(std::optional<RefinedSpot> spot) { spot_ = spot; }
  // Tries again where a server was lost, after waits that grow.
  void tendLost(AutomaticResume::Clock::time_point now);
  // How long until the next attempt; nullopt while no server is lost.
  [[nodiscard]] std::optional<std::chrono::milliseconds> nextResumeAfter(
      AutomaticResume::Clock::time_point now) const;

 private:
  struct Births {
    uint64_t changeCount = 0;  // of the update that told of them
    std::vector<VertexSlot> slots;
  };
  struct MeshOfScene {
    SceneMesh placed;
    std::unique_ptr<Receiver> receiver;
    AutomaticResume resume;
    std::vector<uint32_t> pixels;  // of the last counts, brought up to the mesh as it is
    std::vector<VertexSlot> rim;   // that addRims() found
    std::vector<uint8_t> lift;     // levels, by slot
    double apparentSize = 0;       // as compareSizes() found it
    unsigned levelsBehind = 0;
    bool introduced = false;     // by news
    uint64_t told = 0;           // the change count that the last news led to
    std::vector<Births> births;  // that no counts have seen yet
    size_t share = 0;            // of the next request's records
  };
  void bringUpToDate(MeshOfScene& mesh, const MeshCounts& counts);
  SeenPixels takePixels(const SceneCounts& counts);
  bool addRims(const SeenPixels& seen, const SceneCounts& counts);
  [[nodiscard]] bool rimsFitLast(const SeenPixels& seen, size_t nodes) const;
  [[nodiscard]] bool rimsMayJoin(const SeenPixels& seen) const;
  [[nodiscard]] size_t batchNow() const;
  void liftAll(const SceneCounts& counts);
  void rankAhead(const SceneCounts& counts);
  void compareSizes(const Camera& camera);
  [[nodiscard]] bool ranksByLikelyError() const {
    return options_.receiver.order == RankOrder::significance;
  }
  void shareOut();
  void planBudgets(const SceneCounts& counts);
  void workBudgets();

  std::vector<MeshOfScene> meshes_;
  const SceneOptions options_;
  std::vector<bool> newborn_;  // by slot; working space
  FrontBudget budget_;
  std::vector<size_t> budgeted_;  // by mesh of budget_'s last look: ours
  bool budgetHasMore_ = false;
  uint64_t view_ = 0;  // a number for each camera and picture
  Camera viewedFrom_;
  PixelSize viewedAt_;
  std::optional<RefinedSpot> spot_;
  double finalShare_ = 0;
  uint64_t collapses_ = 0;
  uint64_t resplits_ = 0;
  size_t next_ = 0;  // the mesh whose turn it is in advance()
};

}  // namespace meshfront
