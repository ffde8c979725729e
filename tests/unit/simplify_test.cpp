#include "encoder/simplification/simplify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <string>

#include "shared/hierarchy/node_id.h"
#include "tests/data/closed_manifold_check.h"
#include "tests/data/mesh_shapes.h"
#include "tests/data/nasty_meshes.h"
#include "tests/unit/face_set_model.h"

namespace meshfront {
namespace {

Simplification simplify(const SimplifyInput& input, const SimplifyOptions& options = {}) {
  return meshfront::simplify(input.positions, input.virtualCount, input.triangles,
                             input.realTriangleCount, options);
}

SimplifyOptions options(double baseFraction, unsigned balance) {
  SimplifyOptions result;
  result.baseFraction = baseFraction;
  result.balance = balance;
  return result;
}

void expectSame(const EndState& actual, const EndState& expected) {
  EXPECT_EQ(actual.directions, expected.directions);
  EXPECT_EQ(actual.smallestComponent, expected.smallestComponent);
  EXPECT_EQ(actual.virtualVertex, expected.virtualVertex);
  EXPECT_EQ(actual.components, expected.components);
  EXPECT_EQ(actual.smallestComponents, expected.smallestComponents);
  EXPECT_EQ(actual.handles, expected.handles);
  // The model names one rule only, and not always the link condition first.
  if (actual.depth == 0) {
    EXPECT_EQ(actual.link, expected.link);
  }
}

void expectValid(const SimplifyInput& input, const Simplification& result,
                 const std::string& name) {
  SCOPED_TRACE(name);
  FaceSetModel model(input);
  for (size_t i = 0; i < result.collapses.size(); ++i) {
    ASSERT_EQ(model.apply(result.collapses[i]), "") << "collapse " << i;
  }
  EXPECT_EQ(model.whyNotManifold(), "");
  const SimplifyReport& report = result.report;
  EXPECT_EQ(model.maxHeight(), report.maxHeight);
  EXPECT_EQ(report.baseVertices + result.collapses.size(), input.positions.size());
  if (report.why == StopReason::reachedBase) {
    EXPECT_LE(report.baseVertices, report.wantedVertices);
  } else {
    EXPECT_EQ(report.why, StopReason::noValidCollapse);
    EXPECT_GT(report.baseVertices, report.wantedVertices);
    EXPECT_FALSE(model.canCollapse());
    expectSame(report.endState, model.endState());
  }
}

TEST(Simplify, LogsAreValidOnNastyMeshes) {
  size_t collapses = 0;
  for (const NastyMesh& nasty : nastyMeshes()) {
    if (nasty.vanishes || nasty.mesh.triangles.size() > 20000) continue;
    const SimplifyInput input = closedInput(nasty.mesh);
    const Simplification result = simplify(input, options(0, 1));
    expectValid(input, result, nasty.name);
    collapses += result.collapses.size();
  }
  EXPECT_GT(collapses, 100U);
}

TEST(Simplify, LogsAreValidOnRandomSoups) {
  for (uint32_t seed = 0; seed < 20; ++seed) {
    const SimplifyInput input = closedInput(randomSoup(seed, 10 + 10 * seed, 300));
    ASSERT_FALSE(input.triangles.empty());
    expectValid(input, simplify(input, options(0, seed % 3)), "seed " + std::to_string(seed));
  }
}

TEST(Simplify, ReachesTheBaseAskedFor) {
  const SimplifyInput input = closedInput(sphere(4));  // 1026 vertices
  for (const double fraction : {1.0, 0.5, 0.1, 0.02}) {
    const Simplification result = simplify(input, options(fraction, 1));
    expectValid(input, result, std::to_string(fraction));
    EXPECT_EQ(result.report.why, StopReason::reachedBase);
    EXPECT_EQ(result.report.baseVertices, std::ceil(fraction * 1026));
  }
}

TEST(Simplify, TakesAnyFractionForAValidOne) {
  const SimplifyInput input = closedInput(sphere(2));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double fraction : {0.0, -1.0, nan}) {
    EXPECT_EQ(simplify(input, options(fraction, 1)).report.baseVertices, 4U);
  }
  EXPECT_TRUE(simplify(input, options(7, 1)).collapses.empty());
}

TEST(Simplify, LeavesTetrahedraAlone) {
  IndexedMesh mesh;
  for (int i = 0; i < 3; ++i) appendMesh(mesh, tetrahedron(), {3.0 * i, 0, 0});
  const Simplification result = simplify(closedInput(mesh), options(0, 1));
  EXPECT_TRUE(result.collapses.empty());
  EXPECT_EQ(result.report.why, StopReason::noValidCollapse);
  EXPECT_EQ(result.report.baseVertices, 12U);
}

TEST(Simplify, ReducesEachComponentToATetrahedron) {
  IndexedMesh mesh;
  for (int i = 0; i < 20; ++i) appendMesh(mesh, sphere(1), {3.0 * i, 0, 0});
  const SimplifyInput input = closedInput(mesh);
  const Simplification result = simplify(input, options(0, 1));
  expectValid(input, result, "spheres");
  EXPECT_EQ(result.report.baseVertices, 80U);
}

TEST(Simplify, KeepsTheGenusOfATorus) {
  const SimplifyInput input = closedInput(torus(24, 12));
  const Simplification result = simplify(input, options(0, 1));
  expectValid(input, result, "torus");
  EXPECT_GE(result.report.baseVertices, 7U);  // the smallest triangulation there is
  EXPECT_LE(result.report.baseVertices, 12U);
}

TEST(Simplify, TellsThatTopologyHoldsWhatIsLeft) {
  IndexedMesh mesh = torus(24, 12);
  for (int i = 0; i < 5; ++i) appendMesh(mesh, tetrahedron(), {10.0 + 3 * i, 0, 0});
  const EndState end = simplify(closedInput(mesh), options(0, 1)).report.endState;
  EXPECT_EQ(end.components, 6U);
  EXPECT_EQ(end.smallestComponents, 5U);
  EXPECT_EQ(end.smallestComponent, 5U * 12);
  EXPECT_EQ(end.handles, 1U);
  EXPECT_GT(end.link, 0U);
  EXPECT_EQ(end.link + end.smallestComponent, end.directions);
  EXPECT_EQ(end.depthAlone + end.valenceAlone, 0U);
}

TEST(Simplify, TellsThatDepthHoldsWhatIsLeft) {
  // A three-sided tube whose rings stand ever farther apart: from the dense end on, without
  // balance, one tree swallows one vertex after another.
  constexpr uint32_t kRings = 250;
  SimplifyInput input;
  double at = 0;
  for (uint32_t ring = 0; ring < kRings; ++ring) {
    const auto x = static_cast<int32_t>(std::lround(at));
    input.positions.insert(input.positions.end(), {{x, 0, 0}, {x, 900000, 0}, {x, 0, 900000}});
    at += 10 * std::pow(1.03, ring);
    for (uint32_t side = 0; ring > 0 && side < 3; ++side) {
      const uint32_t a = 3 * ring + side;
      const uint32_t b = 3 * ring + (side + 1) % 3;
      input.triangles.push_back({a, b, b - 3});
      input.triangles.push_back({a, b - 3, a - 3});
    }
  }
  const uint32_t last = 3 * (kRings - 1);
  input.triangles.push_back({0, 1, 2});
  input.triangles.push_back({last, last + 2, last + 1});
  input.realTriangleCount = input.triangles.size();
  const SimplifyReport report = simplify(input, options(0, 0)).report;
  ASSERT_EQ(report.why, StopReason::noValidCollapse);
  EXPECT_EQ(report.maxHeight, kMaxDepth);
  EXPECT_GT(report.endState.depth, 0U);
  EXPECT_GT(report.endState.depthAlone, 0U);
  EXPECT_EQ(simplify(input, options(0, 2)).report.why, StopReason::reachedBase);
}

TEST(Simplify, TellsThatValenceHoldsWhatIsLeft) {
  const SimplifyInput input = closedInput(torus(24, 12));  // all vertices have six neighbours
  SimplifyOptions limited = options(0, 1);
  limited.maxValence = 5;
  const SimplifyReport report = simplify(input, limited).report;
  ASSERT_EQ(report.why, StopReason::noValidCollapse);
  EXPECT_EQ(report.baseVertices, input.positions.size());
  const EndState& end = report.endState;
  EXPECT_EQ(end.directions, 6 * input.positions.size());
  EXPECT_EQ(end.valence, end.directions);
  EXPECT_EQ(end.valenceAlone, end.directions);
  EXPECT_EQ(end.valenceNeeded, 6U);
  EXPECT_EQ(end.link + end.depth, 0U);
  limited.maxValence = 6;
  EXPECT_LT(simplify(input, limited).report.baseVertices, input.positions.size() / 4);
}

TEST(Simplify, TakesHubsIfAllowedTo) {
  // A cone. A hub in the flat bottom, close to the outline, is the cheapest to remove.
  constexpr uint32_t kAround = 200;
  SimplifyInput input;
  for (uint32_t i = 0; i < kAround; ++i) {
    const double angle = 2 * 3.14159265358979 * i / kAround;
    input.positions.push_back({static_cast<int>(std::lround(8000 + 8000 * std::cos(angle))),
                               static_cast<int>(std::lround(8000 + 8000 * std::sin(angle))), 0});
  }
  input.positions.push_back({15990, 8000, 0});
  input.positions.push_back({8000, 8000, 8000});
  for (uint32_t i = 0; i < kAround; ++i) {
    const uint32_t next = (i + 1) % kAround;
    input.triangles.push_back({next, i, kAround});
    input.triangles.push_back({i, next, kAround + 1});
  }
  input.realTriangleCount = input.triangles.size();
  for (const uint32_t limit : {64U, 256U, kLargestMaxValence, 5000U}) {
    SimplifyOptions wide = options(0, 1);
    wide.maxValence = limit;
    const Simplification result = simplify(input, wide);
    expectValid(input, result, "limit " + std::to_string(limit));
    ASSERT_FALSE(result.collapses.empty());
    EXPECT_EQ(result.collapses[0].removed == kAround, limit >= kAround);
  }
}

TEST(Simplify, IsTheSameEachTime) {
  const SimplifyInput input = closedInput(gridPatch(30, 30));
  const Simplification first = simplify(input);
  const Simplification second = simplify(input);
  ASSERT_EQ(first.collapses.size(), second.collapses.size());
  for (size_t i = 0; i < first.collapses.size(); ++i) {
    EXPECT_EQ(first.collapses[i].kept, second.collapses[i].kept);
    EXPECT_EQ(first.collapses[i].removed, second.collapses[i].removed);
  }
}

TEST(Simplify, PutsTheFlatBeforeTheBent) {
  // A plane with one spike: the spike's tip must outlast nearly all of the plane.
  IndexedMesh mesh = gridPatch(20, 20);
  const uint32_t tip = 21 * 10 + 10;
  mesh.positions[tip][2] = 5;
  const SimplifyInput input = closedInput(mesh);
  ASSERT_GT(input.positions[tip][2], 0);
  const Simplification result = simplify(input, options(0.04, 1));
  EXPECT_EQ(result.report.why, StopReason::reachedBase);
  for (const Collapse& collapse : result.collapses) EXPECT_NE(collapse.removed, tip);
}

TEST(Simplify, KeepsOutlines) {
  const SimplifyInput input = closedInput(gridPatch(20, 20), 10);
  const Simplification result = simplify(input, options(0.05, 1));
  expectValid(input, result, "plane");
  std::vector<bool> alive(input.positions.size(), true);
  for (const Collapse& collapse : result.collapses) alive[collapse.removed] = false;
  size_t corners = 0;
  for (size_t v = 0; v < alive.size(); ++v) {
    const auto [x, y, z] = input.positions[v];
    if (alive[v] && (x == 0 || x == 1023) && (y == 0 || y == 1023)) ++corners;
  }
  EXPECT_EQ(corners, 4U);
  // Every vertex that was on the outline stands for, and went to, one on the outline.
  const auto onOutline = [&](uint32_t v) {
    const auto [x, y, z] = input.positions[v];
    return x == 0 || x == 1023 || y == 0 || y == 1023;
  };
  for (const Collapse& collapse : result.collapses) {
    if (onOutline(collapse.removed)) {
      EXPECT_TRUE(onOutline(collapse.kept));
    }
  }
}

TEST(Simplify, TurnsNoFaceOverUnlessNothingElseIsLeft) {
  const SimplifyInput input = closedInput(gridPatch(24, 24), 12);
  const Simplification result = simplify(input, options(0.05, 0));
  EXPECT_EQ(result.report.acceptedFlips, 0U);
  FaceSetModel model(input);
  for (const Collapse& collapse : result.collapses) ASSERT_EQ(model.apply(collapse), "");
  for (const Triangle& t : model.triangles()) {
    if (std::max({t[0], t[1], t[2]}) >= input.positions.size()) continue;
    const GridPosition& a = input.positions[t[0]];
    const GridPosition& b = input.positions[t[1]];
    const GridPosition& c = input.positions[t[2]];
    EXPECT_GT((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]), 0);
  }
}

TEST(Simplify, EndsWhenAllPointsAreEqual) {
  for (unsigned balance : {0U, 1U, 2U}) {
    SimplifyInput input = closedInput(sphere(4));
    for (GridPosition& p : input.positions) p = {5, 5, 5};
    const Simplification result = simplify(input, options(0, balance));
    expectValid(input, result, "balance " + std::to_string(balance));
  }
}

TEST(Simplify, BalanceKeepsTreesShallow) {
  const SimplifyInput input = closedInput(gridPatch(60, 60));
  const unsigned loose = simplify(input, options(0, 0)).report.maxHeight;
  const unsigned balanced = simplify(input, options(0, 1)).report.maxHeight;
  const unsigned tight = simplify(input, options(0, 2)).report.maxHeight;
  EXPECT_LT(balanced, loose);
  EXPECT_LE(tight, balanced);
  EXPECT_LE(balanced, 30U);
}

TEST(Simplify, CopesWithOneVertexOfHugeValence) {
  // Two tips over a ring: both have 5,000 neighbours.
  constexpr uint32_t kAround = 5000;
  SimplifyInput input;
  for (uint32_t i = 0; i < kAround; ++i) {
    const double angle = 2 * 3.14159265358979 * i / kAround;
    input.positions.push_back({static_cast<int>(std::lround(8000 + 8000 * std::cos(angle))),
                               static_cast<int>(std::lround(8000 + 8000 * std::sin(angle))), 0});
  }
  input.positions.push_back({8000, 8000, 4000});
  input.positions.push_back({8000, 8000, -4000});
  for (uint32_t i = 0; i < kAround; ++i) {
    const uint32_t next = (i + 1) % kAround;
    input.triangles.push_back({i, next, kAround});
    input.triangles.push_back({next, i, kAround + 1});
  }
  input.realTriangleCount = input.triangles.size();
  const Simplification result = simplify(input, options(0.01, 1));
  EXPECT_EQ(result.report.why, StopReason::reachedBase);
  EXPECT_EQ(result.report.baseVertices, 51U);
}

// A ring around two tips; every other vertex of the ring is cut off from the lower tip, so that its
// two neighbours are adjacent and may not go onto the upper tip.
TEST(Simplify, KeepsTheLinkConditionAtHugeValences) {
  constexpr uint32_t kAround = 200;
  constexpr uint32_t kUpper = kAround;
  constexpr uint32_t kLower = kAround + 1;
  for (uint32_t seed = 0; seed < 10; ++seed) {
    SimplifyInput input;
    std::mt19937 random(seed);
    for (uint32_t v = 0; v < kAround + 2; ++v) {
      const auto coordinate = [&] { return static_cast<int32_t>(random() % 20); };
      input.positions.push_back({coordinate(), coordinate(), coordinate()});
    }
    for (uint32_t i = 0; i < kAround; i += 2) {
      const uint32_t middle = i + 1;
      const uint32_t next = (i + 2) % kAround;
      input.triangles.push_back({i, middle, kUpper});
      input.triangles.push_back({middle, next, kUpper});
      input.triangles.push_back({next, middle, i});
      input.triangles.push_back({next, i, kLower});
    }
    input.realTriangleCount = input.triangles.size();
    expectValid(input, simplify(input, options(0, 0)), "seed " + std::to_string(seed));
  }
}

// Whatever is in the way at first is tried again when the neighbourhood has changed.
TEST(Simplify, TriesParkedVerticesAgain) {
  for (uint32_t seed = 0; seed < 40; ++seed) {
    SimplifyInput input = closedInput(seed % 2 == 0 ? torus(9, 3 + seed % 5) : sphere(2));
    std::mt19937 random(seed);
    for (GridPosition& p : input.positions) {
      for (int32_t& c : p) c = static_cast<int32_t>(random() % 1000);
    }
    expectValid(input, simplify(input, options(0, 1)), "seed " + std::to_string(seed));
  }
}

TEST(Simplify, RefusesWhatIsNotClosed) {
  const SimplifyInput whole = closedInput(sphere(2));
  SimplifyInput broken = whole;
  broken.triangles.pop_back();
  EXPECT_EQ(simplify(broken).report.why, StopReason::notClosed);
  broken.triangles.pop_back();  // an even number of corners again
  EXPECT_EQ(simplify(broken).report.why, StopReason::notClosed);
  broken = whole;
  std::swap(broken.triangles[7][0], broken.triangles[7][1]);
  EXPECT_EQ(simplify(broken).report.why, StopReason::notClosed);
  broken = whole;
  broken.triangles[3][2] = 1000;
  EXPECT_EQ(simplify(broken).report.why, StopReason::notClosed);
  // Two spheres that share a vertex: every edge is fine, the vertex has two fans.
  IndexedMesh two = sphere(1);
  const auto count = static_cast<uint32_t>(two.positions.size());
  appendMesh(two, sphere(1), {2, 0, 0});
  for (Triangle& t : two.triangles) std::replace(t.begin(), t.end(), count, 0U);
  broken.positions.assign(two.positions.size(), {});
  broken.triangles = two.triangles;
  const Simplification result = simplify(broken);
  EXPECT_EQ(result.report.why, StopReason::notClosed);
  EXPECT_TRUE(result.collapses.empty());
}

TEST(Simplify, TakesAnEmptyMesh) {
  const Simplification result = simplify(SimplifyInput{});
  EXPECT_TRUE(result.collapses.empty());
  EXPECT_EQ(result.report.baseVertices, 0U);
}

TEST(Simplify, TellsItsProgress) {
  const SimplifyInput input = closedInput(gridPatch(200, 200));
  std::vector<size_t> told;
  const Simplification result =
      meshfront::simplify(input.positions, input.virtualCount, input.triangles,
                          input.realTriangleCount, {}, [&](size_t done, size_t planned) {
                            EXPECT_LE(done, planned);
                            told.push_back(done);
                          });
  ASSERT_EQ(told.size(), result.collapses.size() / 16384);
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
}

}  // namespace
}  // namespace meshfront
