// Fronts under budgets, with pixel counts estimated anew from the mesh as it is each time, and
// records from memory in place of a service.
#include "shared/refinement/front_budget.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "load/projected_pixels.h"
#include "shared/camera/camera_spec.h"
#include "shared/receiver/ranking.h"
#include "tests/data/mesh_shapes.h"
#include "tests/unit/encoded_mesh.h"

namespace meshfront {
namespace {

struct Changes {
  uint64_t collapses = 0;
  uint64_t resplits = 0;
  uint64_t records = 0;  // new ones
  uint64_t forgotten = 0;
  Changes& operator+=(const Changes& other) {
    collapses += other.collapses;
    resplits += other.resplits;
    records += other.records;
    forgotten += other.forgotten;
    return *this;
  }
  [[nodiscard]] bool none() const { return collapses + resplits + records + forgotten == 0; }
};

// One mesh or several, all at the same place.
class BudgetedScene {
 public:
  BudgetedScene(const std::vector<IndexedMesh>& meshes, const FrontLimits& limits)
      : budget(limits) {
    for (const IndexedMesh& mesh : meshes) {
      records_.push_back(std::make_unique<RecordsAtHand>(encodedContent(mesh)));
      this->meshes.push_back(SelectivelyRefinedMesh::fromBase(records_.back()->base()).value());
      (void)this->meshes.back().takeUpdate();
      baseBytes_ += this->meshes.back().bytes();
    }
    pixels_.resize(meshes.size());
  }

  // What one frame leads to; checks the budgets after each step.
  Changes frame(const Camera& camera, uint64_t view) {
    Changes changes;
    std::vector<MeshInView> inView;
    const PixelSize picture{400, 400};
    for (size_t i = 0; i < meshes.size(); ++i)
      inView.push_back({&meshes[i],
                        pixels_[i].count(meshes[i], quantization(i), bounds(i), camera, picture),
                        meshes[i].changeCount()});
    budget.look(inView, view, newRecords);
    FrontOutcome outcome;
    do {
      outcome = budget.work(3);
      changes.collapses += outcome.collapses;
      changes.resplits += outcome.resplits;
      for (const auto& forgotten : outcome.forgotten) changes.forgotten += forgotten.size();
      EXPECT_EQ(outcome.damaged, 0U);
      expectWithinLimits();
    } while (outcome.more);
    for (size_t i = 0; i < meshes.size(); ++i) {
      auto wanted = visibleCandidates(meshes[i], inView[i].pixels, {});
      keepFirst(wanted, newRecords, RankOrder::significance);
      for (const Candidate& candidate : wanted) {
        if (budget.splitsAllowed() == 0) break;
        EXPECT_TRUE(records_[i]->split(meshes[i], candidate.node));
        ++changes.records;
        expectWithinLimits();
      }
    }
    return changes;
  }
  // Frames until nothing changes any more; how many it took.
  unsigned framesToSettle(const Camera& camera, uint64_t view, unsigned most) {
    for (unsigned frame = 0; frame < most; ++frame)
      if (this->frame(camera, view).none()) return frame;
    return most;
  }

  [[nodiscard]] Camera cameraAt(const std::string& spec) const {
    return placeCamera(*parseCameraSpec(spec), bounds(0), 1);
  }
  // Vertices that cover pixels and could still be split.
  [[nodiscard]] size_t unsplitInView(const Camera& camera) {
    size_t count = 0;
    for (size_t i = 0; i < meshes.size(); ++i) {
      const auto pixels =
          pixels_[i].count(meshes[i], quantization(i), bounds(i), camera, {400, 400});
      for (VertexSlot slot = 0; slot < pixels.size(); ++slot) {
        const NodeIndex node = meshes[i].nodeAt(slot);
        count += node != kNone && pixels[slot] > 0 && !meshes[i].isLeaf(node) ? 1 : 0;
      }
    }
    return count;
  }
  // Of the base meshes, and what refining has added to it.
  [[nodiscard]] uint64_t baseBytes() const { return baseBytes_; }
  [[nodiscard]] double addedBytes() const {
    return static_cast<double>(budget.bytes()) - static_cast<double>(baseBytes_);
  }
  void expectWithinLimits() {
    ASSERT_LE(budget.triangles(), budget.limits().triangles);
    ASSERT_LE(budget.bytes(), budget.limits().bytes);
    mostTriangles = std::max(mostTriangles, budget.triangles());
    mostBytes = std::max(mostBytes, budget.bytes());
  }

  std::vector<SelectivelyRefinedMesh> meshes;
  FrontBudget budget;
  size_t newRecords = 200;
  uint64_t mostTriangles = 0;
  uint64_t mostBytes = 0;

 private:
  [[nodiscard]] const Quantization& quantization(size_t i) const {
    return records_[i]->content().metadata.quantization;
  }
  [[nodiscard]] Bounds bounds(size_t i) const {
    const Quantization& grid = quantization(i);
    const int32_t most = grid.maximum();
    return Bounds::of(grid.toWorld({0, 0, 0}), grid.toWorld({most, most, most}));
  }

  std::vector<std::unique_ptr<RecordsAtHand>> records_;
  std::vector<ProjectedPixels> pixels_;
  uint64_t baseBytes_ = 0;
};

uint64_t partOf(double part, uint64_t base, double added) {
  return base + static_cast<uint64_t>(part * added);
}

constexpr unsigned kStillFrames = 200;
const char* const kClose = "close;azimuth=30;elevation=20";

std::string orbitSpec(double azimuth) {
  return "close;elevation=15;azimuth=" + std::to_string(azimuth);
}

TEST(FrontBudget, AStillViewComesToRestUnderEveryBudget) {
  uint64_t whole = 0;
  double wholeBytes = 0;
  uint64_t baseBytes = 0;
  {
    BudgetedScene free({sphere(5)}, {});
    free.framesToSettle(free.cameraAt(kClose), 1, kStillFrames);
    whole = free.budget.triangles();
    wholeBytes = free.addedBytes();
    baseBytes = free.baseBytes();
  }
  for (const double share : {0.3, 0.7, 0.95, 2.0})
    for (const bool ofBytes : {false, true}) {
      SCOPED_TRACE(std::to_string(share) + (ofBytes ? " of the bytes" : " of the triangles"));
      FrontLimits limits;
      if (ofBytes) limits.bytes = partOf(share, baseBytes, wholeBytes);
      if (!ofBytes) limits.triangles = static_cast<uint64_t>(share * static_cast<double>(whole));
      BudgetedScene scene({sphere(5)}, limits);
      // Coming from elsewhere, so that there is something to collapse.
      scene.framesToSettle(scene.cameraAt("close;azimuth=200;elevation=-30"), 1, 50);
      const Camera camera = scene.cameraAt(kClose);
      const unsigned frames = scene.framesToSettle(camera, 2, kStillFrames);
      EXPECT_LT(frames, kStillFrames / 2);
      for (unsigned i = 0; i < kStillFrames; ++i) ASSERT_TRUE(scene.frame(camera, 2).none()) << i;
      if (share > 1) {
        EXPECT_EQ(scene.unsplitInView(camera), 0U);
      }
    }
}

// Goes round once, waiting at each of twelve places until nothing changes there.
Changes goRound(BudgetedScene& scene, uint64_t& view) {
  Changes all;
  for (int azimuth = 0; azimuth < 360; azimuth += 30) {
    const Camera camera = scene.cameraAt("elevation=0;azimuth=" + std::to_string(azimuth));
    ++view;
    Changes last;
    for (unsigned i = 0; i < 80; ++i) all += last = scene.frame(camera, view);
    EXPECT_TRUE(last.none());
    EXPECT_EQ(scene.unsplitInView(camera), 0U);
  }
  return all;
}

// A wall round the y axis, seen from outside alone: whatever is seen grazing is also seen well.
IndexedMesh roundWall() {
  constexpr uint32_t kAround = 120;
  constexpr uint32_t kHigh = 24;
  IndexedMesh wall;
  for (uint32_t z = 0; z <= kHigh; ++z)
    for (uint32_t i = 0; i < kAround; ++i) {
      const double angle = 2 * std::numbers::pi * i / kAround;
      const double radius = 10 + 0.3 * std::sin(7 * angle) * std::cos(0.4 * z);
      wall.positions.push_back({radius * std::sin(angle), 0.5 * z, radius * std::cos(angle)});
    }
  for (uint32_t z = 0; z < kHigh; ++z)
    for (uint32_t i = 0; i < kAround; ++i) {
      const uint32_t a = z * kAround + i;
      const uint32_t b = z * kAround + (i + 1) % kAround;
      wall.triangles.push_back({a, b, b + kAround});
      wall.triangles.push_back({a, b + kAround, a + kAround});
    }
  return wall;
}

TEST(FrontBudget, GoingRoundASecondTimeTransfersNothing) {
  uint64_t view = 0;
  BudgetedScene scene({roundWall()}, {});
  EXPECT_GT(goRound(scene, view).records, 2'000U);
  EXPECT_TRUE(goRound(scene, view).none());

  // With triangles for little more than what is seen at a time, parts go and come back, from what
  // is kept.
  BudgetedScene narrow({roundWall()}, {.triangles = scene.budget.triangles() * 7 / 10});
  EXPECT_GT(goRound(narrow, view).records, 2'000U);
  const Changes again = goRound(narrow, view);
  EXPECT_EQ(again.records, 0U);
  EXPECT_EQ(again.forgotten, 0U);
  EXPECT_GT(again.resplits, 500U);
  EXPECT_GT(again.collapses, 500U);
}

TEST(FrontBudget, GoingRoundWhatHasAnEdgeOfViewSoonTransfersNothing) {
  // Below, a sphere is never seen. What is just seen there depends on how fine its surroundings
  // are, which are finer the second time.
  uint64_t view = 0;
  BudgetedScene scene({sphere(5)}, {});
  const uint64_t first = goRound(scene, view).records;
  EXPECT_LE(goRound(scene, view).records, first / 100);
  EXPECT_EQ(goRound(scene, view).records, 0U);
}

TEST(FrontBudget, HoldsOnARandomFlightOverSeveralMeshes) {
  std::vector<IndexedMesh> shapes = {sphere(5), torus(60, 30), sphere(4)};
  uint64_t triangles = 0;
  uint64_t bytes = 0;
  {
    BudgetedScene free(shapes, {});
    free.framesToSettle(free.cameraAt(kClose), 1, 50);
    triangles = free.budget.triangles();
    bytes = partOf(0.7, free.baseBytes(), free.addedBytes());
  }
  const FrontLimits limits{.triangles = triangles / 2, .bytes = bytes};
  BudgetedScene scene(shapes, limits);
  std::mt19937 random(3);
  Changes all;
  for (uint64_t view = 1; view < 150; ++view) {
    const std::string spec = "zoom=" + std::to_string(1 + random() % 6) +
                             ";azimuth=" + std::to_string(random() % 360) +
                             ";elevation=" + std::to_string(random() % 80);
    const Camera camera = scene.cameraAt(spec);
    for (unsigned i = 0; i <= random() % 5; ++i) all += scene.frame(camera, view);
  }
  // The budgets are used, not only held.
  EXPECT_GT(scene.mostTriangles, limits.triangles * 9 / 10);
  EXPECT_GT(scene.mostBytes, limits.bytes * 8 / 10);
  EXPECT_GT(all.collapses, 1'000U);
  EXPECT_GT(all.resplits, 1'000U);
}

TEST(FrontBudget, ForgetsWhatWasNotNeededForLongest) {
  // Bytes for about a third of the records.
  uint64_t bytes = 0;
  {
    BudgetedScene free({sphere(5)}, {});
    for (double azimuth = 0; azimuth < 360; azimuth += 60)
      free.framesToSettle(free.cameraAt(orbitSpec(azimuth)), static_cast<uint64_t>(azimuth) + 1,
                          40);
    bytes = partOf(0.4, free.baseBytes(), free.addedBytes());
  }
  BudgetedScene scene({sphere(5)}, {.bytes = bytes});
  Changes all;
  for (uint64_t view = 0; view < 24; ++view)
    for (unsigned i = 0; i < 20; ++i)
      all += scene.frame(scene.cameraAt(orbitSpec(static_cast<double>(view) * 60)), view);
  EXPECT_GT(all.forgotten, 500U);
  EXPECT_GT(all.records, 3'000U);  // what was forgotten came again
}

TEST(FrontBudget, ObeysALowerLimit) {
  BudgetedScene scene({sphere(5)}, {});
  const Camera camera = scene.cameraAt(kClose);
  scene.framesToSettle(camera, 1, 60);
  const uint64_t before = scene.budget.triangles();
  const std::vector<uint32_t> everywhere(scene.meshes[0].vertexSlotCount(), 1);
  scene.budget = FrontBudget({.triangles = before / 2});
  for (unsigned i = 0; i < 40; ++i) {
    scene.budget.look(
        std::array{MeshInView{scene.meshes.data(), everywhere, scene.meshes[0].changeCount()}}, 1,
        0);
    while (scene.budget.work(100).more) {
    }
  }
  EXPECT_LE(scene.budget.triangles(), before / 2);
  EXPECT_EQ(scene.budget.splitsAllowed(), 0U);
}

TEST(FrontBudget, CollapsesAnUnneededShareOnlyIfTold) {
  for (const double share : {1.0, 0.2}) {
    BudgetedScene scene({sphere(5)}, {.unneededShare = share});
    scene.framesToSettle(scene.cameraAt("close;azimuth=0"), 1, 60);
    const uint64_t before = scene.budget.triangles();
    const Camera behind = scene.cameraAt("close;azimuth=180");
    Changes changes;
    for (unsigned i = 0; i < 60; ++i) changes += scene.frame(behind, 2);
    EXPECT_EQ(changes.collapses > 0, share < 1);
    const auto needed = static_cast<double>(scene.budget.neededVertices());
    const auto unneeded = static_cast<double>(scene.budget.unneededVertices());
    if (share < 1) {
      EXPECT_LT(scene.budget.triangles(), before);
      EXPECT_LT(unneeded, needed);
    } else {
      EXPECT_GT(unneeded, needed);
      EXPECT_GT(scene.budget.triangles(), before);
    }
    EXPECT_EQ(scene.unsplitInView(behind), 0U);
    EXPECT_TRUE(scene.frame(behind, 2).none());
  }
}

TEST(FrontBudget, PinnedAndUncountedVerticesStay) {
  BudgetedScene scene({sphere(4)}, {});
  const Camera camera = scene.cameraAt("close;azimuth=0");
  scene.framesToSettle(camera, 1, 60);
  SelectivelyRefinedMesh& mesh = scene.meshes[0];
  const std::vector<uint32_t> nothing(mesh.vertexSlotCount(), 0);
  const uint64_t applied = mesh.splitsApplied();
  scene.budget = FrontBudget({.unneededShare = 0});
  const auto lookAt = [&](uint64_t countedAt, uint64_t view) {
    scene.budget.look(std::array{MeshInView{&mesh, nothing, countedAt}}, view, 0);
    while (scene.budget.work(10).more) {
    }
  };
  lookAt(0, 2);  // counted before the first split
  EXPECT_EQ(mesh.splitsApplied(), applied);
  for (NodeIndex node = 0; node < mesh.nodeCount(); ++node) mesh.setPinned(node, true);
  lookAt(mesh.changeCount(), 3);
  EXPECT_EQ(mesh.splitsApplied(), applied);
  for (NodeIndex node = 0; node < mesh.nodeCount(); ++node) mesh.setPinned(node, false);
  lookAt(mesh.changeCount(), 4);
  EXPECT_LT(mesh.splitsApplied(), applied);
}

TEST(FrontBudget, DropsADamagedKeptRecord) {
  const RecordsAtHand records(encodedContent(torus(30, 20)));
  auto mesh = SelectivelyRefinedMesh::fromBase(records.base()).value();
  NodeIndex root = 0;
  while (mesh.isLeaf(root)) ++root;
  const auto& place = records.of(mesh.id(root));
  ASSERT_TRUE(
      mesh.keepRecord(root, *place.bytes, place.entry.bitOffset, place.entry.bitLength - 1));
  std::vector<uint32_t> pixels(mesh.vertexSlotCount(), 0);
  pixels[mesh.slot(root)] = 50;
  EXPECT_TRUE(visibleCandidates(mesh, pixels, {}, {.withoutKept = true}).empty());
  FrontBudget budget({});
  budget.look(std::array{MeshInView{&mesh, pixels, mesh.changeCount()}}, 1, 0);
  EXPECT_EQ(budget.work(10).damaged, 1U);
  EXPECT_EQ(mesh.splitsApplied(), 0U);
  EXPECT_EQ(visibleCandidates(mesh, pixels, {}).size(), 1U);
}

}  // namespace
}  // namespace meshfront
