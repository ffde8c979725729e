#include "encoder/cleaning/close_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "tests/data/closed_manifold_check.h"
#include "tests/data/mesh_shapes.h"
#include "tests/data/nasty_meshes.h"

namespace meshfront {
namespace {

using Point = std::array<double, 3>;
using PlacedTriangle = std::array<Point, 3>;

// How often each oriented triangle occurs, by its corners' positions; degenerate ones left out.
std::map<PlacedTriangle, int> placedTriangles(const std::vector<Point>& positions,
                                              std::span<const Triangle> triangles) {
  std::map<PlacedTriangle, int> placed;
  for (const Triangle& t : triangles) {
    PlacedTriangle p = {positions[t[0]], positions[t[1]], positions[t[2]]};
    if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) continue;
    std::rotate(p.begin(), std::min_element(p.begin(), p.end()), p.end());
    ++placed[p];
  }
  return placed;
}

struct Cleaned {
  ClosedMesh mesh;
  CleaningReport report;
};

Cleaned cleaned(const IndexedMesh& mesh) {
  Cleaned result;
  auto closed = closeMesh(mesh, result.report);
  EXPECT_TRUE(closed) << closed.error().message;
  if (closed) result.mesh = std::move(*closed);
  return result;
}

// Everything closeMesh() promises, whatever the input.
void expectPromisesKept(const IndexedMesh& input) {
  const auto [mesh, report] = cleaned(input);
  EXPECT_EQ(whyNotClosedManifold(mesh.vertexCount(), mesh.triangles), "");

  // The drawn triangles are the input's, each once.
  auto expected = placedTriangles(input.positions, input.triangles);
  for (auto& [triangle, times] : expected) times = 1;
  const auto real = std::span(mesh.triangles).first(mesh.realTriangleCount);
  EXPECT_EQ(placedTriangles(mesh.positions, real), expected);
  for (const Triangle& t : real)
    for (const uint32_t corner : t) EXPECT_FALSE(mesh.isVirtual(corner));
  for (size_t i = mesh.realTriangleCount; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    EXPECT_FALSE(mesh.isVirtual(t[0]) || mesh.isVirtual(t[1]));
    EXPECT_TRUE(mesh.isVirtual(t[2]));
  }

  EXPECT_EQ(report.verticesIn, input.positions.size());
  EXPECT_EQ(report.trianglesIn, input.triangles.size());
  EXPECT_EQ(report.trianglesIn - report.degenerateFaces - report.repeatedFaces,
            mesh.realTriangleCount);
  EXPECT_EQ(report.verticesIn - report.weldedVertices - report.unreferencedVertices +
                report.verticesSplit,
            mesh.positions.size());
  EXPECT_EQ(report.boundaryLoops, mesh.virtualCount);
}

// Loose corners (to weld), each face also turned round (to copy) and a vertex without faces.
IndexedMesh repeatedFacesBackToBack() {
  const IndexedMesh grid = gridPatch(3, 3);
  IndexedMesh mesh;
  for (const Triangle& t : grid.triangles) {
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (const uint32_t corner : t) mesh.positions.push_back(grid.positions[corner]);
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 1});
  }
  mesh.positions.insert(mesh.positions.begin(), {9, 9, 9});
  for (Triangle& t : mesh.triangles)
    for (uint32_t& corner : t) ++corner;
  return mesh;
}

TEST(CloseMesh, KeepsItsPromisesOnEveryNastyMesh) {
  for (const NastyMesh& nasty : nastyMeshes()) {
    SCOPED_TRACE(nasty.name);
    if (nasty.vanishes) {
      CleaningReport report;
      EXPECT_FALSE(closeMesh(nasty.mesh, report));
      EXPECT_EQ(report.degenerateFaces, nasty.mesh.triangles.size());
    } else {
      expectPromisesKept(nasty.mesh);
    }
  }
}

TEST(CloseMesh, KeepsItsPromisesOnRandomSoups) {
  for (uint32_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    expectPromisesKept(randomSoup(seed, 4 + seed % 40, 10 + seed * 2));
  }
}

TEST(CloseMesh, KeepsItsPromisesOnRandomPatchworks) {
  for (uint32_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    expectPromisesKept(randomPatchwork(seed));
  }
}

TEST(CloseMesh, IsDeterministic) {
  const IndexedMesh soup = randomSoup(77, 30, 500);
  const auto first = cleaned(soup);
  const auto second = cleaned(soup);
  EXPECT_EQ(first.mesh.positions, second.mesh.positions);
  EXPECT_EQ(first.mesh.triangles, second.mesh.triangles);
}

TEST(CloseMesh, LeavesAClosedMeshAsItIs) {
  const IndexedMesh input = torus(12, 7);
  const auto [mesh, report] = cleaned(input);
  EXPECT_EQ(mesh.positions, input.positions);
  EXPECT_EQ(mesh.triangles, input.triangles);
  EXPECT_EQ(report.boundaryLoops, 0U);
  EXPECT_EQ(report.verticesSplit, 0U);
  EXPECT_EQ(report.components, 1U);
}

TEST(CloseMesh, ClosesASingleTriangleToATetrahedron) {
  const auto [mesh, report] = cleaned({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
  const std::vector<Triangle> expected = {{0, 1, 2}, {1, 0, 3}, {2, 1, 3}, {0, 2, 3}};
  EXPECT_EQ(mesh.triangles, expected);
  EXPECT_EQ(mesh.virtualCount, 1U);
  EXPECT_EQ(report.boundaryLoops, 1U);
}

TEST(CloseMesh, WeldsEqualCoordinatesAndNegativeZero) {
  const auto [mesh, report] = cleaned(
      {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 1, 1e-300}},
       {{0, 1, 2}, {1, 4, 5}, {3, 3, 6}, {0, 3, 6}}});
  EXPECT_EQ(report.weldedVertices, 2U);
  EXPECT_EQ(report.degenerateFaces, 2U);
  EXPECT_EQ(report.unreferencedVertices, 1U);
  EXPECT_EQ(mesh.positions.size(), 4U);
  EXPECT_EQ(report.boundaryLoops, 1U);
}

TEST(CloseMesh, CarriesColoursAndNormalsAlong) {
  IndexedMesh input = repeatedFacesBackToBack();
  for (size_t i = 0; i < input.positions.size(); ++i) {  // each tells its position
    const auto [x, y, z] = input.positions[i];
    input.colours.push_back({uint8_t(x), uint8_t(y), uint8_t(z), 7});
    input.normals.push_back({float(x), float(y), float(z)});
  }
  const auto [mesh, report] = cleaned(input);
  EXPECT_GT(report.weldedVertices, 0U);
  EXPECT_GT(report.verticesSplit, 0U);
  EXPECT_GT(report.unreferencedVertices, 0U);
  EXPECT_EQ(report.weldedDifferently, 0U);
  ASSERT_EQ(mesh.colours.size(), mesh.positions.size());
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const auto [x, y, z] = mesh.positions[i];
    EXPECT_EQ(mesh.colours[i], (Colour{uint8_t(x), uint8_t(y), uint8_t(z), 7}));
    EXPECT_EQ(mesh.normals[i], (std::array<float, 3>{float(x), float(y), float(z)}));
  }
  EXPECT_TRUE(cleaned(torus(4, 4)).mesh.colours.empty());
}

TEST(CloseMesh, KeepsTheFirstOfDifferentColoursAndNormalsAndCounts) {
  IndexedMesh input;
  input.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 1, 1}};
  input.triangles = {{0, 1, 2}, {5, 4, 6}, {3, 2, 6}};
  input.colours.assign(7, {1, 2, 3, 4});
  input.normals.assign(7, {0, 0, 1});
  input.colours[3][3] = 5;
  input.normals[4][0] = 1;
  const auto [mesh, report] = cleaned(input);
  EXPECT_EQ(report.weldedVertices, 3U);
  EXPECT_EQ(report.weldedDifferently, 2U);
  for (const Colour& colour : mesh.colours) EXPECT_EQ(colour, (Colour{1, 2, 3, 4}));
  for (const auto& normal : mesh.normals) EXPECT_EQ(normal, (std::array<float, 3>{0, 0, 1}));
}

TEST(CloseMesh, RefusesAttributesOfSomeVerticesOnly) {
  CleaningReport report;
  IndexedMesh mesh = tetrahedron();
  mesh.colours.resize(3);
  EXPECT_FALSE(closeMesh(mesh, report));
  mesh.colours.clear();
  mesh.normals.resize(5);
  EXPECT_FALSE(closeMesh(mesh, report));
}

TEST(CloseMesh, RefusesCoordinatesWhoseDistanceOverflows) {
  CleaningReport report;
  IndexedMesh mesh = tetrahedron();
  mesh.positions[0][1] = -1.7e308;
  EXPECT_TRUE(closeMesh(mesh, report));
  mesh.positions[2][1] = 1.7e308;
  const auto closed = closeMesh(mesh, report);
  ASSERT_FALSE(closed);
  EXPECT_EQ(closed.error().message,
            "cleaning: the coordinates lie too far apart for 64-bit numbers; scale the mesh");
}

TEST(CloseMesh, DropsRepeatsAndSetsOppositesApart) {
  // Face 0 again, rotated; turned round; turned round and rotated.
  const IndexedMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                         {{0, 1, 2}, {1, 2, 0}, {0, 2, 1}, {2, 1, 0}}};
  const auto result = cleaned(mesh);
  EXPECT_EQ(result.report.repeatedFaces, 2U);
  EXPECT_EQ(result.report.oppositeDuplicates, 1U);
  EXPECT_EQ(result.report.verticesSplit, 3U);
  EXPECT_EQ(result.report.components, 2U);
  EXPECT_EQ(result.mesh.triangles[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(result.mesh.triangles[1], (Triangle{3, 4, 5}));
}

TEST(CloseMesh, KeepsBothSidesOfASheetWhole) {
  IndexedMesh sheet = gridPatch(4, 4);
  const size_t count = sheet.triangles.size();
  for (size_t i = 0; i < count; ++i)
    sheet.triangles.push_back(
        {sheet.triangles[i][0], sheet.triangles[i][2], sheet.triangles[i][1]});
  const auto [mesh, report] = cleaned(sheet);
  EXPECT_EQ(report.oppositeDuplicates, count);
  EXPECT_EQ(report.components, 2U);
  EXPECT_EQ(report.boundaryLoops, 2U);
  EXPECT_EQ(mesh.positions.size(), 50U);
}

TEST(CloseMesh, CutsAnEdgeWithThreeFaces) {
  const auto [mesh, report] = cleaned({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}},
                                       {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}});
  EXPECT_EQ(report.nonManifoldEdges, 1U);
  EXPECT_EQ(report.verticesSplit, 4U);
  EXPECT_EQ(report.components, 3U);
  EXPECT_EQ(report.boundaryLoops, 3U);
}

TEST(CloseMesh, CutsBetweenFacesOfDifferentOrientation) {
  const auto [mesh, report] =
      cleaned({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 1, 3}}});
  EXPECT_EQ(report.inconsistentEdges, 1U);
  EXPECT_EQ(report.verticesSplit, 2U);
  EXPECT_EQ(report.components, 2U);
}

TEST(CloseMesh, ClosesSolidsThatTouchAlongAnEdgeEachByItself) {
  const auto touching = [](const std::array<int, 3>& second) {
    return cleaned(cubesSurface({2, 2, 2}, [&](const std::array<int, 3>& c) {
      return c == std::array<int, 3>{} || c == second;
    }));
  };
  const auto edge = touching({1, 1, 0});
  EXPECT_EQ(edge.report.nonManifoldEdges, 1U);
  EXPECT_EQ(edge.report.rejoinedEdges, 2U);
  EXPECT_EQ(edge.report.verticesSplit, 2U);
  EXPECT_EQ(edge.report.boundaryLoops, 0U);
  EXPECT_EQ(edge.report.components, 2U);
  const auto corner = touching({1, 1, 1});
  EXPECT_EQ(corner.report.verticesSplit, 1U);
  EXPECT_EQ(corner.report.components, 2U);
}

TEST(CloseMesh, CutsAMoebiusStripAtOneSeam) {
  for (const NastyMesh& nasty : nastyMeshes()) {
    if (nasty.name != "moebius-strip") continue;
    const auto [mesh, report] = cleaned(nasty.mesh);
    EXPECT_EQ(report.inconsistentEdges, 1U);
    EXPECT_EQ(report.verticesSplit, 2U);
    EXPECT_EQ(report.boundaryLoops, 1U);
    EXPECT_EQ(report.components, 1U);
    return;
  }
  FAIL() << "no such mesh";
}

TEST(CloseMesh, CountsBoundariesAndComponents) {
  std::map<std::string, CleaningReport> reports;
  for (const NastyMesh& nasty : nastyMeshes())
    if (!nasty.vanishes) reports[nasty.name] = cleaned(nasty.mesh).report;
  EXPECT_EQ(reports["1600-components"].components, 1600U);
  EXPECT_EQ(reports["1600-components"].boundaryLoops, 1200U);
  EXPECT_EQ(reports["sphere-with-50-holes"].boundaryLoops, 50U);
  EXPECT_EQ(reports["sphere-with-50-holes"].unreferencedVertices, 50U);
  EXPECT_EQ(reports["plate-with-holes"].boundaryLoops, 101U);
  EXPECT_EQ(reports["cylinder"].boundaryLoops, 2U);
  EXPECT_EQ(reports["genus-3"].boundaryLoops, 0U);
  EXPECT_EQ(reports["two-sheets-at-a-vertex"].components, 2U);
  EXPECT_EQ(reports["far-apart"].components, 3U);
}

TEST(CloseMesh, HasTheGenusOfItsInput) {
  for (const auto& [name, characteristic] :
       std::map<std::string, long>{{"sphere", 2}, {"torus", 0}, {"genus-3", -4}}) {
    for (const NastyMesh& nasty : nastyMeshes()) {
      if (nasty.name != name) continue;
      const auto [mesh, report] = cleaned(nasty.mesh);
      const long faces = static_cast<long>(mesh.triangles.size());
      EXPECT_EQ(static_cast<long>(mesh.vertexCount()) - faces / 2, characteristic) << name;
    }
  }
}

TEST(CloseMesh, RefusesAnIndexOutOfRange) {
  CleaningReport report;
  const auto closed = closeMesh({{{0, 0, 0}, {1, 0, 0}}, {{0, 1, 2}}}, report);
  ASSERT_FALSE(closed);
  EXPECT_EQ(closed.error().message, "cleaning: vertex index 2 is out of range");
}

TEST(ClosedManifoldCheck, FindsWhatIsWrong) {
  const std::vector<Triangle> good = tetrahedron().triangles;
  EXPECT_EQ(whyNotClosedManifold(4, good), "");
  EXPECT_EQ(whyNotClosedManifold(5, good), "unused vertex 4");
  EXPECT_EQ(whyNotClosedManifold(3, good), "index out of range in (0, 1, 3)");
  auto open = good;
  open.pop_back();
  EXPECT_EQ(whyNotClosedManifold(4, open), "no reverse of edge 0 -> 2");
  auto flipped = good;
  std::swap(flipped[3][0], flipped[3][1]);
  EXPECT_EQ(whyNotClosedManifold(4, flipped), "a directed edge occurs again in (0, 2, 3)");
  const std::vector<Triangle> pillow = {{0, 1, 2}, {0, 2, 1}};
  EXPECT_EQ(whyNotClosedManifold(3, pillow), "a second face on the corners of (0, 2, 1)");
  auto touching = good;  // a second tetrahedron at vertex 0
  for (Triangle t : good) {
    for (uint32_t& corner : t) corner = corner == 0 ? 0 : corner + 3;
    touching.push_back(t);
  }
  EXPECT_EQ(whyNotClosedManifold(7, touching), "several fans at vertex 0");
}

}  // namespace
}  // namespace meshfront
