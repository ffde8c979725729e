#include "tests/evaluation/sender_experiments/drawn_client.h"

#include <algorithm>
#include <chrono>

#include "shared/bits/crc32c.h"
#include "shared/receiver/ranking.h"
#include "shared/receiver/request_budget.h"
#include "shared/scene/likely_error.h"

namespace meshfront::evaluation {
namespace {

using DrawnClock = std::chrono::steady_clock;

constexpr size_t kStep = 20'000;        // operations of the budget, new records at a time
constexpr double kUnneededShare = 0.2;  // of the vertices

double secondsSinceThen(DrawnClock::time_point start) {
  return std::chrono::duration<double>(DrawnClock::now() - start).count();
}

}  // namespace

Result<DrawingTools> DrawingTools::create() {
  auto context = GlContext::createHeadless();
  if (!context) return tl::unexpected(context.error());
  auto renderer = MeshRenderer::create();
  if (!renderer) return tl::unexpected(renderer.error());
  auto target = RenderTarget::create(kPictureSize);
  if (!target) return tl::unexpected(target.error());
  PixelCounter counter = PixelCounter::create(PixelCounter::preferred(*context));
  return DrawingTools{std::move(*context), std::move(*renderer), std::move(*target),
                      std::move(counter)};
}

Result<DrawnClient> DrawnClient::create(const MeasuredMesh& mesh, DrawingTools& tools) {
  auto begun = SelectivelyRefinedMesh::fromBase(mesh.model.base());
  if (!begun) return tl::unexpected(begun.error());
  return DrawnClient(mesh, tools, std::move(*begun));
}

DrawnClient::DrawnClient(const MeasuredMesh& source, DrawingTools& tools,
                         SelectivelyRefinedMesh mesh)
    : source_(&source),
      tools_(&tools),
      mesh_(std::make_unique<SelectivelyRefinedMesh>(std::move(mesh))),
      gpuMesh_(source.model.quantization(), mesh_->attributeLayout().colours),
      budget_([] {
        FrontLimits limits;
        limits.unneededShare = kUnneededShare;
        return limits;
      }()) {}

Result<void> DrawnClient::upload() {
  if (gpuMesh_.changeCount() == mesh_->changeCount()) return {};
  const auto applied = gpuMesh_.apply(mesh_->takeUpdate());
  if (!applied) return tl::unexpected(applied.error());
  return {};
}

Result<std::span<const uint32_t>> DrawnClient::count(const Camera& camera) {
  if (auto uploaded = upload(); !uploaded) return tl::unexpected(uploaded.error());
  tools_->renderer.drawItems(tools_->target, gpuMesh_, camera, source_->bounds);
  tools_->counter.count(tools_->target, gpuMesh_, pixels_);
  return std::span<const uint32_t>(pixels_);
}

Result<Picture> DrawnClient::draw(const Camera& camera) {
  if (auto uploaded = upload(); !uploaded) return tl::unexpected(uploaded.error());
  tools_->renderer.draw(tools_->target, gpuMesh_, camera, source_->bounds, DrawStyle());
  return tools_->target.readPicture();
}

Result<double> DrawnClient::timeDrawing(const Camera& camera) {
  if (auto uploaded = upload(); !uploaded) return tl::unexpected(uploaded.error());
  const auto start = DrawnClock::now();
  tools_->renderer.draw(tools_->target, gpuMesh_, camera, source_->bounds, DrawStyle());
  (void)tools_->target.itemAt(0, 0);  // waits for the picture
  return secondsSinceThen(start);
}

Result<void> DrawnClient::split(NodeIndex node) {
  const SenderModel& model = source_->model;
  const uint32_t number = model.find(mesh_->id(node));
  if (number == kNoNode) return fail("a node without a record");
  return mesh_->split(node, model.recordBytes(), model.recordBegin(number),
                      model.recordBits(number));
}

Result<DrawnClient::Refined> DrawnClient::refine(const Camera& camera, unsigned rounds) {
  Refined refined;
  ++views_;
  for (unsigned round = 0; round < rounds; ++round) {
    const auto counted = count(camera);
    if (!counted) return tl::unexpected(counted.error());
    const auto start = DrawnClock::now();
    const MeshInView inView{mesh_.get(), *counted, mesh_->changeCount()};
    budget_.look({&inView, 1}, views_, kStep);
    uint64_t changed = 0;
    for (bool more = true; more;) {
      const FrontOutcome outcome = budget_.work(kStep);
      refined.collapses += outcome.collapses;
      refined.splits += outcome.resplits;
      changed += outcome.collapses + outcome.resplits;
      more = outcome.more;
    }
    RankingBias bias;
    bias.withoutKept = true;
    std::vector<Candidate> wanted = visibleCandidates(*mesh_, *counted, {}, bias);
    keepFirst(wanted, kStep, RankOrder::significance);
    for (const Candidate& candidate : wanted) {
      // The count is of the mesh before the budget's work.
      if (!mesh_->isActive(candidate.node)) continue;
      if (auto done = split(candidate.node); !done) return tl::unexpected(done.error());
      ++refined.records;
      ++changed;
    }
    refined.seconds += secondsSinceThen(start);
    if (changed == 0) break;
  }
  return refined;
}

Result<uint64_t> DrawnClient::fetch(const Camera& camera, uint64_t& up) {
  const auto counted = count(camera);
  if (!counted) return tl::unexpected(counted.error());
  const Quantization& grid = source_->model.quantization();
  const glm::dvec3 origin(grid.origin[0], grid.origin[1], grid.origin[2]);
  std::vector<uint8_t> lift;
  liftByLikelyError(*mesh_, *counted, (camera.eye - origin) / grid.step,
                    pixelsAtOne(camera, kPictureSize), lift);
  RankingBias bias;
  bias.lift = lift;
  bias.levelsBehind = kMostErrorLift;
  std::vector<Candidate> wanted = visibleCandidates(*mesh_, *counted, {}, bias);
  keepFirst(wanted, adaptiveBatch(mesh_->splitsApplied()), RankOrder::significance);
  if (wanted.empty()) return 0;
  uint64_t bits = 0;
  std::vector<uint32_t> nodes;
  for (const Candidate& candidate : wanted) {
    nodes.push_back(source_->model.find(candidate.id));
    bits += source_->model.recordBits(nodes.back());
    if (auto done = split(candidate.node); !done) return tl::unexpected(done.error());
  }
  std::sort(nodes.begin(), nodes.end());
  const auto request = setRequest(source_->model, nodes);
  if (!request) return tl::unexpected(request.error());
  up += request->ids.size();
  return (bits + 7) / 8 + kChecksumBytes;
}

}  // namespace meshfront::evaluation
