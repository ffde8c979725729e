#include "tests/data/nasty_meshes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>

#include "tests/data/mesh_shapes.h"

namespace meshfront {
namespace {

IndexedMesh singleTriangle() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
}

IndexedMesh manyOf(const IndexedMesh& part, uint32_t columns, uint32_t rows, double distance) {
  IndexedMesh mesh;
  for (uint32_t y = 0; y < rows; ++y)
    for (uint32_t x = 0; x < columns; ++x) appendMesh(mesh, part, {x * distance, y * distance, 0});
  return mesh;
}

IndexedMesh tinyComponents() {  // 1,600 of them, of four kinds
  IndexedMesh mesh;
  const std::array<IndexedMesh, 4> kinds = {singleTriangle(), tetrahedron(), gridPatch(1, 1),
                                            gridPatch(2, 2)};
  for (uint32_t i = 0; i < 1600; ++i)
    appendMesh(mesh, kinds[i % 4], {i % 40 * 3.0, std::floor(i / 40.0) * 3, 0});
  return mesh;
}

IndexedMesh ringOfSquares(uint32_t squares, bool twisted) {  // a cylinder or a Moebius strip
  IndexedMesh mesh;
  for (uint32_t i = 0; i < squares; ++i) {
    const double a = 2 * std::numbers::pi * i / squares;
    const double tilt = twisted ? a / 2 : 0;
    for (const double side : {-0.4, 0.4}) {
      const double radius = 2 + side * std::sin(tilt);
      mesh.positions.push_back({radius * std::cos(a), radius * std::sin(a), side * std::cos(tilt)});
    }
  }
  for (uint32_t i = 0; i < squares; ++i) {
    const uint32_t low = 2 * i;
    const bool seam = twisted && i + 1 == squares;
    const uint32_t nextLow = (2 * i + 2) % (2 * squares) + (seam ? 1 : 0);
    const uint32_t nextHigh = (2 * i + 2) % (2 * squares) + (seam ? 0 : 1);
    mesh.triangles.push_back({low, nextLow, nextHigh});
    mesh.triangles.push_back({low, nextHigh, low + 1});
  }
  return mesh;
}

IndexedMesh fan(uint32_t blades, bool closed) {
  IndexedMesh mesh{{{0, 0, 0.5}}, {}};
  for (uint32_t i = 0; i < blades; ++i) {
    const double a = 2 * std::numbers::pi * i / blades;
    mesh.positions.push_back({std::cos(a), std::sin(a), 0});
  }
  for (uint32_t i = 0; i + (closed ? 0 : 1) < blades; ++i)
    mesh.triangles.push_back({0, i + 1, (i + 1) % blades + 1});
  return mesh;
}

IndexedMesh doublePyramid(uint32_t sides) {  // two vertices of high degree that share their ring
  IndexedMesh mesh = fan(sides, true);
  const auto bottom = static_cast<uint32_t>(mesh.positions.size());
  mesh.positions.push_back({0, 0, -0.5});
  for (uint32_t i = 0; i < sides; ++i)
    mesh.triangles.push_back({bottom, (i + 1) % sides + 1, i + 1});
  return mesh;
}

IndexedMesh pagesOfABook(uint32_t pages) {  // one edge with that many faces
  IndexedMesh mesh{{{0, 0, 0}, {0, 0, 1}}, {}};
  for (uint32_t i = 0; i < pages; ++i) {
    const double a = 2 * std::numbers::pi * i / pages;
    mesh.positions.push_back({std::cos(a), std::sin(a), 0.5});
    if (i % 2 == 0)
      mesh.triangles.push_back({0, 1, i + 2});
    else
      mesh.triangles.push_back({1, 0, i + 2});
  }
  return mesh;
}

IndexedMesh twoSheetsAtAVertex() {
  IndexedMesh mesh = gridPatch(3, 3);
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  appendMesh(mesh, gridPatch(3, 3), {0, 0, 1});
  for (Triangle& t : mesh.triangles)
    for (uint32_t& corner : t)
      if (corner == first + 5) corner = 5;
  return mesh;
}

IndexedMesh backToBack(IndexedMesh mesh) {  // every face again, turned round
  const size_t count = mesh.triangles.size();
  for (size_t i = 0; i < count; ++i) {
    const Triangle t = mesh.triangles[i];
    mesh.triangles.push_back({t[0], t[2], t[1]});
  }
  return mesh;
}

IndexedMesh repeatedFaces() {
  IndexedMesh mesh = gridPatch(2, 2);
  const Triangle t = mesh.triangles[3];
  mesh.triangles.insert(mesh.triangles.end(), {t, {t[1], t[2], t[0]}, {t[2], t[1], t[0]}, t});
  return mesh;
}

IndexedMesh flippedNeighbour() {
  IndexedMesh mesh = gridPatch(4, 4);
  std::swap(mesh.triangles[13][0], mesh.triangles[13][1]);
  return mesh;
}

IndexedMesh everyThirdFlipped(IndexedMesh mesh) {
  for (size_t i = 0; i < mesh.triangles.size(); i += 3)
    std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
  return mesh;
}

IndexedMesh kleinBottle(uint32_t around, uint32_t tube) {  // closed, but with no outside
  IndexedMesh mesh = torus(around, tube);
  for (Triangle& t : mesh.triangles) {
    // Where the last tube circle meets the first one, it is glued on the other way round.
    const bool seam = *std::max_element(t.begin(), t.end()) >= (around - 1) * tube &&
                      *std::min_element(t.begin(), t.end()) < tube;
    for (uint32_t& corner : t)
      if (seam && corner < tube) corner = (tube - corner) % tube;
  }
  return mesh;
}

IndexedMesh withFlaps(IndexedMesh mesh) {  // a triangle more on the first edge of every face
  const size_t count = mesh.triangles.size();
  for (size_t i = 0; i < count; ++i) {
    const Triangle t = mesh.triangles[i];
    const auto apex = static_cast<uint32_t>(mesh.positions.size());
    auto place = mesh.positions[t[0]];
    place[2] += 1;
    mesh.positions.push_back(place);
    mesh.triangles.push_back({t[0], t[1], apex});
  }
  return mesh;
}

IndexedMesh starOfTriangles(uint32_t count) {  // they share one vertex and nothing else
  IndexedMesh mesh{{{0, 0, 0}}, {}};
  for (uint32_t i = 0; i < count; ++i) {
    const double a = 2 * std::numbers::pi * i / count;
    mesh.positions.push_back({std::cos(a), std::sin(a), i * 0.01});
    mesh.positions.push_back({std::cos(a + 0.001), std::sin(a + 0.001), i * 0.01});
    mesh.triangles.push_back({0, 2 * i + 1, 2 * i + 2});
  }
  return mesh;
}

IndexedMesh scaled(IndexedMesh mesh, double factor, const std::array<double, 3>& offset = {}) {
  for (auto& p : mesh.positions)
    for (size_t axis = 0; axis < 3; ++axis) p[axis] = p[axis] * factor + offset[axis];
  return mesh;
}

IndexedMesh noisilyColoured(IndexedMesh mesh) {
  std::mt19937 random(7);
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    Colour colour{};
    for (uint8_t& channel : colour) channel = static_cast<uint8_t>(random() >> 24);
    mesh.colours.push_back(colour);
    std::array<float, 3> normal{};
    for (float& component : normal) component = float(random() >> 8) * 0x1p-23F - 1;
    if (i % 11 == 0) normal = {};  // none
    mesh.normals.push_back(normal);
  }
  return mesh;
}

IndexedMesh placed(IndexedMesh mesh, std::array<double, 3> (*place)(uint32_t vertex)) {
  for (uint32_t i = 0; i < mesh.positions.size(); ++i) mesh.positions[i] = place(i);
  return mesh;
}

IndexedMesh comb() {  // a long boundary: 60 teeth, every vertex on it
  return gridPatchWithout(120, 12, [](uint32_t x, uint32_t y) { return y > 0 && x % 2 == 1; });
}

IndexedMesh sphereWithHoles(unsigned holes) {  // each where a vertex and its faces are gone
  IndexedMesh mesh = sphere(4);
  std::vector<std::set<uint32_t>> around(mesh.positions.size());
  for (const Triangle& t : mesh.triangles)
    for (const uint32_t a : t) around[a].insert(t.begin(), t.end());
  std::set<uint32_t> gone;
  std::set<uint32_t> taken;  // in or beside a hole
  for (uint32_t v = 0; v < mesh.positions.size() && gone.size() < holes; v += 7) {
    const auto isTaken = [&](uint32_t n) { return taken.contains(n); };
    if (std::any_of(around[v].begin(), around[v].end(), isTaken)) continue;
    gone.insert(v);
    taken.insert(around[v].begin(), around[v].end());
  }
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return gone.contains(t[0]) || gone.contains(t[1]) || gone.contains(t[2]);
  });
  return mesh;
}

IndexedMesh threeHolesBlock() {  // genus 3, each cube cut into 2 x 2 x 2
  return cubesSurface({14, 6, 2}, [](const std::array<int, 3>& c) {
    return !(c[0] / 2 % 2 == 1 && c[1] / 2 == 1);
  });
}

IndexedMesh cubesTouching(const std::array<int, 3>& second) {  // (0, 0, 0) and another one
  return cubesSurface({2, 2, 2}, [&](const std::array<int, 3>& c) {
    return c == std::array<int, 3>{} || c == second;
  });
}

IndexedMesh checkeredCubes() {  // every cube touches others in edges and corners only
  return cubesSurface({4, 4, 4},
                      [](const std::array<int, 3>& c) { return (c[0] + c[1] + c[2]) % 2 == 0; });
}

IndexedMesh farApart() {  // quantised, each cluster is one grid point
  IndexedMesh mesh = sphere(2);
  appendMesh(mesh, torus(8, 6), {1e9, 1e9, 0});
  appendMesh(mesh, gridPatch(5, 5), {-1e9, 1e9, 0});
  return mesh;
}

IndexedMesh looseCorners(const IndexedMesh& mesh) {  // as STL: no two triangles share a vertex
  IndexedMesh loose;
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<uint32_t>(loose.positions.size());
    for (const uint32_t corner : t) loose.positions.push_back(mesh.positions[corner]);
    loose.triangles.push_back({first, first + 1, first + 2});
  }
  return loose;
}

IndexedMesh withUnusedVertices() {
  IndexedMesh mesh = gridPatchWithout(9, 9, [](uint32_t x, uint32_t y) { return x < 4 && y < 4; });
  mesh.positions.push_back({4, 4, 9});
  return mesh;
}

}  // namespace

std::vector<NastyMesh> nastyMeshes() {
  std::vector<NastyMesh> all;
  const auto add = [&](const char* name, IndexedMesh mesh, bool vanishes = false) {
    all.push_back({name, std::move(mesh), vanishes});
  };
  add("single-triangle", singleTriangle());
  add("two-triangles-apart", manyOf(singleTriangle(), 2, 1, 3));
  add("square", gridPatch(1, 1));
  add("tetrahedron", tetrahedron());
  add("1600-components", tinyComponents());
  add("torus", torus(40, 20));
  add("smallest-torus", torus(3, 3));
  add("thin-torus", torus(600, 3));
  add("klein-bottle", kleinBottle(24, 12));
  add("genus-3", threeHolesBlock());
  add("sphere", sphere(4));
  add("strip", gridPatch(300, 1));
  add("boundary-of-6002-edges", gridPatch(3000, 1));
  add("3000-triangles-apart", manyOf(singleTriangle(), 60, 50, 2));
  add("cylinder", ringOfSquares(50, false));
  add("moebius-strip", ringOfSquares(50, true));
  add("smallest-moebius-strip", ringOfSquares(3, true));
  add("open-fan", fan(200, false));
  add("closed-fan", fan(200, true));
  add("double-pyramid", doublePyramid(500));
  add("edge-with-3-faces", pagesOfABook(3));
  add("edge-with-4-faces", pagesOfABook(4));
  add("edge-with-9-faces", pagesOfABook(9));
  add("flaps", withFlaps(gridPatch(8, 8)));
  add("two-sheets-at-a-vertex", twoSheetsAtAVertex());
  add("star-of-triangles", starOfTriangles(150));
  add("cubes-sharing-an-edge", cubesTouching({1, 1, 0}));
  add("cubes-sharing-a-corner", cubesTouching({1, 1, 1}));
  add("checkered-cubes", checkeredCubes());
  add("pillow-of-two-triangles", backToBack(singleTriangle()));
  add("sheet-back-to-back", backToBack(gridPatch(6, 6)));
  add("sphere-back-to-back", backToBack(sphere(2)));
  add("repeated-faces", repeatedFaces());
  add("flipped-neighbour", flippedNeighbour());
  add("every-third-flipped", everyThirdFlipped(torus(12, 9)));
  add("on-a-line", placed(gridPatch(8, 8), [](uint32_t i) {
        return std::array<double, 3>{double(i), 0, 0};
      }));
  add("in-a-plane", gridPatch(20, 20));
  add("vanishes-in-a-point",
      placed(gridPatch(5, 5),
             [](uint32_t) {
               return std::array<double, 3>{1, 2, 3};
             }),
      true);
  add("vanishes-in-two-points",
      placed(gridPatch(5, 5),
             [](uint32_t i) {
               return std::array<double, 3>{double(i % 2), 0, 0};
             }),
      true);
  add("in-three-points", placed(gridPatch(5, 5), [](uint32_t i) {
        return std::array<double, 3>{double((i + i / 6) % 3), double((i + i / 6) % 3 == 1 ? 1 : 0),
                                     0};
      }));
  add("folded-onto-itself", placed(gridPatch(7, 7), [](uint32_t i) {
        return std::array<double, 3>{double(i % 5), std::floor(i / 8.0), 0};
      }));
  add("comb", comb());
  add("plate-with-holes",
      gridPatchWithout(30, 30, [](uint32_t x, uint32_t y) { return x % 3 == 1 && y % 3 == 1; }));
  add("holes-touching-in-corners",
      gridPatchWithout(12, 12, [](uint32_t x, uint32_t y) { return (x + y) % 2 == 0; }));
  add("sphere-with-50-holes", sphereWithHoles(50));
  add("far-apart", farApart());
  add("on-one-grid-point", scaled(sphere(2), 1000 * std::numeric_limits<double>::denorm_min()));
  add("georeferenced", scaled(sphere(3), 250, {500000.123, 4649776.224, 1234.567}));
  add("huge", scaled(sphere(3), 4e307));
  add("loose-corners", looseCorners(torus(16, 8)));
  add("colours-and-normals", noisilyColoured(torus(20, 10)));
  add("colours-and-normals-at-loose-corners", noisilyColoured(looseCorners(sphere(2))));
  add("colours-and-normals-in-a-soup", noisilyColoured(randomSoup(4, 50, 200)));
  add("unused-vertices", withUnusedVertices());
  add("sparse-soup", randomSoup(1, 400, 300));
  add("soup", randomSoup(2, 60, 300));
  add("dense-soup", randomSoup(3, 12, 300));
  for (uint32_t seed = 1; seed <= 3; ++seed)
    all.push_back({"patchwork-" + std::to_string(seed), randomPatchwork(seed), false});
  return all;
}

IndexedMesh randomSoup(uint32_t seed, uint32_t vertexCount, uint32_t triangleCount) {
  std::mt19937 random(seed);  // its sequence is fixed by the standard, unlike the distributions
  IndexedMesh mesh;
  for (uint32_t i = 0; i < vertexCount; ++i) {
    auto& position = mesh.positions.emplace_back();
    for (double& coordinate : position) coordinate = (random() >> 8) * 0x1p-24;
  }
  for (uint32_t i = 0; i < triangleCount; ++i) {
    auto& triangle = mesh.triangles.emplace_back();
    for (uint32_t& corner : triangle) corner = static_cast<uint32_t>(random() % vertexCount);
  }
  return mesh;
}

IndexedMesh randomPatchwork(uint32_t seed) {
  std::mt19937 random(seed);
  const auto below = [&](size_t end) { return static_cast<uint32_t>(random() % end); };
  const uint32_t columns = 2 + below(12);
  const uint32_t rows = 1 + below(12);
  IndexedMesh mesh = below(3) == 0 ? torus(columns + 1, rows + 2) : gridPatch(columns, rows);
  if (below(4) == 0) appendMesh(mesh, IndexedMesh(mesh), {0.5 * below(3), 0, 0.5 * below(3)});
  for (auto& p : mesh.positions) p[2] += below(1000) * 1e-3;
  const auto vertices = static_cast<uint32_t>(mesh.positions.size());
  const size_t triangles = mesh.triangles.size();
  const std::array<uint32_t, 3> rates = {0, 40, 8};  // one of so many, 0: none
  const auto timesFor = [&](size_t things) {
    const uint32_t rate = rates[below(rates.size())];
    return rate == 0 ? 0 : things / rate + 1;
  };
  for (size_t i = timesFor(triangles); i > 0; --i) {  // flip
    Triangle& t = mesh.triangles[below(triangles)];
    std::swap(t[0], t[1]);
  }
  for (size_t i = timesFor(vertices); i > 0; --i)  // glue by index
    mesh.triangles[below(triangles)][below(3)] = below(vertices);
  for (size_t i = timesFor(vertices); i > 0; --i)  // glue by position
    mesh.positions[below(vertices)] = std::array(mesh.positions[below(vertices)]);
  for (size_t i = timesFor(triangles); i > 0; --i) {  // repeat, some turned round
    Triangle t = mesh.triangles[below(triangles)];
    if (below(2) == 0) std::swap(t[1], t[2]);
    mesh.triangles.push_back(t);
  }
  for (size_t i = timesFor(triangles); i > 0; --i)  // delete
    mesh.triangles.erase(mesh.triangles.begin() + below(mesh.triangles.size()));
  return mesh;
}

}  // namespace meshfront
