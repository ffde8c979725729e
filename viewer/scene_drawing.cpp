#include "viewer/scene_drawing.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "shared/scene/local_error.h"
#include "shared/scene/mesh_placement.h"

namespace meshfront {

SceneDrawing::SceneDrawing(MeshRenderer renderer, PixelCounter counter, MissingBounds missing,
                           RankingPass pass)
    : renderer_(std::move(renderer)),
      counter_(std::move(counter)),
      missing_(std::move(missing)),
      pass_(std::move(pass)) {}

Result<SceneDrawing> SceneDrawing::create(std::span<const SceneMesh> meshes,
                                          PixelCounter::Method countingMethod) {
  auto renderer = MeshRenderer::create();
  if (!renderer) return tl::unexpected(renderer.error());
  auto missing = MissingBounds::create();
  if (!missing) return tl::unexpected(missing.error());
  auto pass = RankingPass::create(countingMethod);
  if (!pass) return tl::unexpected(pass.error());
  SceneDrawing drawing(std::move(*renderer), PixelCounter::create(countingMethod),
                       std::move(*missing), std::move(*pass));
  for (const SceneMesh& mesh : meshes) {
    Drawn& drawn = drawing.meshes_.emplace_back();
    drawn.worldFromMesh = mesh.worldFromMesh;
  }
  return drawing;
}

Result<bool> SceneDrawing::take(std::vector<MeshNews> news, double seconds, size_t byteLimit) {
  bool changed = false;
  for (MeshNews& one : news) {
    Drawn& drawn = meshes_.at(one.mesh);
    if (one.introduced) {
      introduce(one);
      changed = true;
    }
    if (drawn.mesh == nullptr) continue;
    Result<bool> applied = drawn.mesh->apply(std::move(one.update), seconds, byteLimit);
    if (!applied) return applied;
    changed = changed || *applied;
    drawn.taken = true;
  }
  for (Drawn& drawn : meshes_) {
    if (std::exchange(drawn.taken, false) || drawn.mesh == nullptr || !drawn.mesh->isPending())
      continue;
    Result<bool> advanced = drawn.mesh->advance(seconds, byteLimit);
    if (!advanced) return advanced;
    changed = changed || *advanced;
  }
  return changed;
}

void SceneDrawing::introduce(MeshNews& news) {
  Drawn& drawn = meshes_[news.mesh];
  drawn.metadata = std::move(news.introduced);
  drawn.mesh = std::make_unique<GpuMesh>(drawn.metadata->quantization, news.coloured);
  instances_.clear();
  meshOfInstance_.clear();
  radii_.clear();
  bounds_.reset();
  for (size_t i = 0; i < meshes_.size(); ++i) {
    const Drawn& one = meshes_[i];
    if (one.mesh == nullptr) continue;
    instances_.push_back({one.mesh.get(), one.worldFromMesh});
    meshOfInstance_.push_back(i);
    LevelRadii& radii = radii_.emplace_back();
    for (unsigned level = 0; level < radii.size(); ++level)
      radii[level] = static_cast<float>(localError(*one.metadata, level));
    finestLevel_ = std::max(finestLevel_, one.metadata->maxLevel);
    const Bounds world = movedBounds(Bounds::of(one.metadata->boundsMin, one.metadata->boundsMax),
                                     one.worldFromMesh);
    bounds_ = bounds_ ? unitedBounds(*bounds_, world) : world;
  }
}

bool SceneDrawing::isUploading() const {
  return std::any_of(instances_.begin(), instances_.end(),
                     [](const MeshInstance& one) { return one.mesh->isPending(); });
}

bool SceneDrawing::hasColours() const {
  return std::any_of(instances_.begin(), instances_.end(),
                     [](const MeshInstance& one) { return one.mesh->hasColours(); });
}

double SceneDrawing::slidesUntil(double slideSeconds) const {
  return meshfront::slidesUntil(instances_, slideSeconds);
}

void SceneDrawing::draw(RenderTarget& target, const Camera& camera, const Bounds& bounds,
                        DrawStyle style, bool missing, double seconds) {
  style.finestLevel = finestLevel_;
  FrameState frame;
  frame.now = seconds;
  frame.pixels = &shownCounts_;
  renderer_.draw(target, instances_, camera, bounds, style, frame);
  if (missing)
    missing_.draw(target, instances_, radii_, shownCounts_, camera, bounds, finestLevel_);
}

// --- counting ------------------------------------------------------------------------------------

uint64_t SceneDrawing::CountedViews::add(const Camera& camera, PixelSize picture, size_t instances,
                                         bool ahead) {
  views_.push_back({next_, camera, picture, instances, ahead});
  return next_++;
}

std::optional<SceneDrawing::CountedView> SceneDrawing::CountedViews::take(uint64_t tag) {
  while (!views_.empty() && views_.front().tag < tag) views_.pop_front();
  if (views_.empty() || views_.front().tag != tag) return std::nullopt;
  const CountedView view = views_.front();
  views_.pop_front();
  return view;
}

SceneCounts SceneDrawing::countsOf(const PixelCounts& counted) const {
  SceneCounts counts;
  counts.meshes.resize(meshes_.size());
  for (size_t i = 0; i < instances_.size(); ++i) {
    MeshCounts& mesh = counts.meshes[meshOfInstance_[i]];
    mesh.changeCount = counted.changeCounts[i].value_or(0);
    mesh.pixels = counted.pixels[i];
  }
  return counts;
}

bool SceneDrawing::startCount(const RenderTarget& target, const Camera& camera) {
  const auto begin = std::chrono::steady_clock::now();
  const uint64_t tag = views_.add(camera, target.size(), instances_.size(), false);
  const bool started = counter_.start(target, instances_, tag);
  if (!started) views_.dropLast();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  if (started) countSeconds_ = took.count();
  return started;
}

SceneCounts SceneDrawing::countNow(RenderTarget& target, const Camera& camera, const Bounds& bounds,
                                   DrawStyle style) {
  style.finestLevel = finestLevel_;
  renderer_.drawItems(target, instances_, camera, bounds, style);
  counter_.count(target, instances_, taken_.pixels);
  taken_.changeCounts.clear();
  for (const MeshInstance& one : instances_) taken_.changeCounts.push_back(one.mesh->changeCount());
  SceneCounts counts = countsOf(taken_);
  counts.camera = camera;
  counts.picture = target.size();
  return counts;
}

std::optional<SceneCounts> SceneDrawing::takeCounts() {
  if (!counter_.take(taken_)) return std::nullopt;
  const auto view = views_.take(taken_.tag);
  // A mesh that came meanwhile renumbers the instances.
  if (!view || view->instances != instances_.size()) return std::nullopt;
  (void)shownCounts_.set(taken_.pixels);
  SceneCounts counts = countsOf(taken_);
  counts.camera = view->camera;
  counts.picture = view->picture;
  return counts;
}

Result<bool> SceneDrawing::startPass(const Camera& camera, const Bounds& bounds, PixelSize picture,
                                     int divisor, const DrawStyle& style, double seconds,
                                     bool ahead) {
  RankingView view;
  view.camera = camera;
  view.bounds = bounds;
  view.size = picture;
  view.divisor = divisor;
  view.style = style;
  view.frame.now = seconds;
  const uint64_t tag = passViews_.add(camera, picture, instances_.size(), ahead);
  Result<bool> started = pass_.start(renderer_, instances_, view, tag);
  if (!started || !*started) passViews_.dropLast();
  return started;
}

std::optional<SceneCounts> SceneDrawing::takePass() {
  if (!pass_.take(taken_)) return std::nullopt;
  const auto view = passViews_.take(taken_.tag);
  if (!view || view->instances != instances_.size()) return std::nullopt;
  SceneCounts counts = countsOf(taken_);
  counts.camera = view->camera;
  counts.picture = view->picture;
  counts.ahead = view->ahead;
  if (!counts.ahead) (void)shownCounts_.set(taken_.pixels);
  return counts;
}

// --- pointing ------------------------------------------------------------------------------------

std::optional<SceneDrawing::Place> SceneDrawing::placeAt(const RenderTarget& target,
                                                         const Camera& camera, const Bounds& bounds,
                                                         int x, int y) const {
  const std::optional<Picked> picked = pick(target, instances_, camera, bounds, x, y);
  if (!picked) return std::nullopt;
  return Place{meshOfInstance_[picked->instance], picked->slots[picked->nearest], picked->vertex};
}

}  // namespace meshfront
