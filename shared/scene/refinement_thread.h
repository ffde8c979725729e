// A scene's refinement in a thread of its own: what arrives is decoded and applied there, and the
// drawing thread never waits for it.
//
//   drawing thread                                refinement thread
//   takeNews()  <- what changed in each mesh  <-  applies answers, collapses, splits again
//   draw, count pixels
//   see()       -> the latest counts          ->  budgets, ranking, requests
//   status()    <- numbers, a copy            <-
//
// One set of news waits at a time: while the drawing thread does not take it, changes gather in the
// meshes, and applying pauses after kSplitsAhead of them, so that an update stays within what one
// frame can upload. Every function may be called from any one other thread. The transport must
// outlive it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "shared/scene/mesh_news.h"
#include "shared/scene/scene_receiver.h"

namespace meshfront {

// A front vertex, described for a person who points at it.
struct VertexDescription {
  size_t mesh = 0;
  uint32_t slot = 0;
  NodeId node;
  unsigned level = 0;
  bool isLeaf = false;
};

class RefinementThread {
 public:
  static constexpr uint64_t kSplitsAhead = 50'000;

  // `onNews` is called on the refinement thread when there is something to take or to show; it must
  // only wake.
  RefinementThread(std::vector<SceneMesh> meshes, SceneOptions options, Transport& transport,
                   std::function<void()> onNews);
  ~RefinementThread();
  RefinementThread(const RefinementThread&) = delete;
  RefinementThread& operator=(const RefinementThread&) = delete;

  [[nodiscard]] std::vector<MeshNews> takeNews();
  [[nodiscard]] SceneStatus status() const;

  void see(SceneCounts counts);  // replaces counts not looked at yet
  void refineFirst(std::optional<RefinedSpot> spot);
  // Waits for the thread, at most so long; nullopt for a slot that is free, or if it takes longer.
  [[nodiscard]] std::optional<VertexDescription> describe(size_t mesh, uint32_t slot,
                                                          std::chrono::milliseconds longest);

  // Ends the thread; the scene as it was left. Call once.
  [[nodiscard]] SceneReceiver& stop();

 private:
  struct Inputs {
    std::optional<SceneCounts> counts;
    std::optional<SceneCounts> ahead;
    std::optional<std::optional<RefinedSpot>> spot;
    std::optional<std::pair<size_t, uint32_t>> describe;
  };
  [[nodiscard]] SceneOptions waking(SceneOptions options);
  void run();
  [[nodiscard]] std::optional<Inputs> waitForInputs(bool busy);
  bool work(Inputs inputs);
  void rankAgain();
  void tell();
  void publish();
  [[nodiscard]] std::optional<VertexDescription> described(size_t mesh, uint32_t slot) const;

  const std::function<void()> onNews_;
  mutable std::mutex mutex_;  // of what stands up to scene_
  std::condition_variable wake_;
  Inputs inputs_;
  bool stopping_ = false;
  bool arrived_ = false;
  bool newsTaken_ = false;
  std::vector<MeshNews> news_;
  SceneStatus status_;
  std::condition_variable described_;
  std::optional<std::pair<size_t, uint32_t>> describedPlace_;  // that description_ is of
  std::optional<VertexDescription> description_;

  // The thread's alone.
  SceneReceiver scene_;
  std::optional<SceneCounts> counts_;  // the last ones

  std::thread thread_;  // last: starts when all else is there
};

}  // namespace meshfront
