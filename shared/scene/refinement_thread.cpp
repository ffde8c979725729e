#include "shared/scene/refinement_thread.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace meshfront {
namespace {

using std::chrono::milliseconds;

constexpr size_t kSplitsAtATime = 2'000;  // between looks at new counts: a few milliseconds
constexpr milliseconds kIdleWait{250};    // where time alone has something to do: next attempts
constexpr int kNiceness = 5;              // frames come first where processors are few

}  // namespace

RefinementThread::RefinementThread(std::vector<SceneMesh> meshes, SceneOptions options,
                                   Transport& transport, std::function<void()> onNews)
    : onNews_(std::move(onNews)),
      scene_(std::move(meshes), waking(std::move(options)), transport),
      thread_([this] { run(); }) {}

SceneOptions RefinementThread::waking(SceneOptions options) {
  options.receiver.freshRanking = false;  // counts come when the drawing thread has some
  options.receiver.onArrival = [this] {
    const std::lock_guard lock(mutex_);
    arrived_ = true;
    wake_.notify_one();
  };
  return options;
}

RefinementThread::~RefinementThread() {
  if (thread_.joinable()) (void)stop();
}

SceneReceiver& RefinementThread::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    wake_.notify_one();
  }
  thread_.join();
  return scene_;
}

// --- the drawing thread --------------------------------------------------------------------------

std::vector<MeshNews> RefinementThread::takeNews() {
  const std::lock_guard lock(mutex_);
  if (!news_.empty()) {
    newsTaken_ = true;
    wake_.notify_one();
  }
  return std::exchange(news_, {});
}

SceneStatus RefinementThread::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

void RefinementThread::see(SceneCounts counts) {
  const std::lock_guard lock(mutex_);
  (counts.ahead ? inputs_.ahead : inputs_.counts) = std::move(counts);
  wake_.notify_one();
}

void RefinementThread::refineFirst(std::optional<RefinedSpot> spot) {
  const std::lock_guard lock(mutex_);
  inputs_.spot = spot;
  wake_.notify_one();
}

std::optional<VertexDescription> RefinementThread::describe(size_t mesh, uint32_t slot,
                                                            milliseconds longest) {
  std::unique_lock lock(mutex_);
  const std::pair place(mesh, slot);
  inputs_.describe = place;
  describedPlace_.reset();
  wake_.notify_one();
  // What is described late, for a call that has given up, is of another place.
  const auto isDescribed = [&] { return describedPlace_ == place; };
  if (!described_.wait_for(lock, longest, isDescribed)) return std::nullopt;
  return description_;
}

// --- the refinement thread -----------------------------------------------------------------------

void RefinementThread::run() {
  // Linux counts niceness by thread. Nothing depends on it.
  (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNiceness);
  bool busy = true;
  while (std::optional<Inputs> inputs = waitForInputs(busy)) busy = work(std::move(*inputs));
}

std::optional<RefinementThread::Inputs> RefinementThread::waitForInputs(bool busy) {
  std::unique_lock lock(mutex_);
  const auto due = [this] {
    return stopping_ || arrived_ || newsTaken_ || inputs_.counts || inputs_.ahead || inputs_.spot ||
           inputs_.describe;
  };
  if (!busy) wake_.wait_for(lock, kIdleWait, due);
  arrived_ = newsTaken_ = false;
  if (stopping_) return std::nullopt;
  return std::exchange(inputs_, {});
}

// True when there is more to do at once.
bool RefinementThread::work(Inputs inputs) {
  if (inputs.spot) scene_.refineFirst(*inputs.spot);
  if (inputs.describe) {
    const auto description = described(inputs.describe->first, inputs.describe->second);
    const std::lock_guard lock(mutex_);
    description_ = description;
    describedPlace_ = inputs.describe;
    described_.notify_one();
  }
  if (inputs.ahead) scene_.rank(*inputs.ahead);
  if (inputs.counts) {
    counts_ = std::move(inputs.counts);
    scene_.rank(*counts_);
  } else if (inputs.spot && counts_) {
    scene_.rank(*counts_);
  } else {
    rankAgain();
  }
  bool busy = false;
  if (scene_.changesUntold() < kSplitsAhead) {
    const uint64_t before = scene_.changeCount();
    const bool finished = scene_.advance(kSplitsAtATime);
    busy = finished || scene_.changeCount() != before;
  }
  scene_.tendLost(AutomaticResume::Clock::now());
  tell();
  publish();
  return busy;
}

// Where what is drawn is what there is, the last counts still hold.
void RefinementThread::rankAgain() {
  if (!counts_ || !scene_.wantsRanking()) return;
  for (size_t i = 0; i < counts_->meshes.size(); ++i) {
    const SelectivelyRefinedMesh* mesh = scene_.receiver(i).mesh();
    if (mesh != nullptr && mesh->changeCount() != counts_->meshes[i].changeCount) return;
  }
  scene_.rank(*counts_);
}

void RefinementThread::tell() {
  {
    const std::lock_guard lock(mutex_);
    if (!news_.empty()) return;
  }
  std::vector<MeshNews> news = scene_.takeNews();
  if (news.empty()) return;
  {
    const std::lock_guard lock(mutex_);
    news_ = std::move(news);
  }
  onNews_();
}

std::optional<VertexDescription> RefinementThread::described(size_t i, uint32_t slot) const {
  if (i >= scene_.meshCount()) return std::nullopt;
  const SelectivelyRefinedMesh* mesh = scene_.receiver(i).mesh();
  if (mesh == nullptr || slot >= mesh->vertexSlotCount()) return std::nullopt;
  const NodeIndex node = mesh->nodeAt(slot);
  if (node == kNone) return std::nullopt;
  return VertexDescription{i, slot, mesh->id(node), mesh->level(node), mesh->isLeaf(node)};
}

void RefinementThread::publish() {
  SceneStatus status = scene_.status();
  if (const auto after = scene_.nextResumeAfter(AutomaticResume::Clock::now()))
    status.secondsToResume = std::chrono::duration<double>(*after).count();
  bool stateChanged = false;
  {
    const std::lock_guard lock(mutex_);
    stateChanged = status.state != status_.state;
    status_ = std::move(status);
  }
  if (stateChanged) onNews_();
}

}  // namespace meshfront
