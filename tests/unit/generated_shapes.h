// Small meshes on a grid, made in code.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "shared/mesh/indexed_mesh.h"
#include "shared/mesh/quantization.h"

namespace meshfront::testing {

struct GridShape {
  Quantization quantization;
  std::vector<GridPosition> positions;
  std::vector<Triangle> triangles;
};

// cells x cells squares of two triangles in the plane z = 0, from (0,0) to (1,1).
inline GridShape planeShape(int cells) {
  GridShape shape;
  shape.quantization = {.bits = 14, .origin = {0, 0, 0}, .step = 1.0 / 16383};
  for (int y = 0; y <= cells; ++y) {
    for (int x = 0; x <= cells; ++x) {
      shape.positions.push_back(shape.quantization.toGrid(
          {static_cast<double>(x) / cells, static_cast<double>(y) / cells, 0}));
    }
  }
  const auto at = [cells](int x, int y) { return static_cast<uint32_t>(y * (cells + 1) + x); };
  for (int y = 0; y < cells; ++y) {
    for (int x = 0; x < cells; ++x) {
      shape.triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      shape.triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  }
  return shape;
}

// A sphere of `radius` around `center`: an octahedron divided `depth` times, 8 * 4^depth triangles,
// each vertex moved outward by bumpiness * radius * a wave.
inline GridShape sphereShape(int depth, double bumpiness = 0,
                             std::array<double, 3> center = {0, 0, 0}, double radius = 1) {
  using Point = std::array<double, 3>;
  std::vector<Point> points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<Triangle> triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                     {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int d = 0; d < depth; ++d) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
    const auto middle = [&](uint32_t a, uint32_t b) {
      const auto [place, fresh] = middles.try_emplace({std::min(a, b), std::max(a, b)},
                                                      static_cast<uint32_t>(points.size()));
      if (fresh) {
        Point m{};
        double squares = 0;
        for (size_t i = 0; i < 3; ++i) {
          m.at(i) = points[a].at(i) + points[b].at(i);
          squares += m.at(i) * m.at(i);
        }
        for (double& component : m) {
          component /= std::sqrt(squares);
        }
        points.push_back(m);
      }
      return place->second;
    };
    std::vector<Triangle> finer;
    for (const Triangle& t : triangles) {
      const uint32_t ab = middle(t[0], t[1]);
      const uint32_t bc = middle(t[1], t[2]);
      const uint32_t ca = middle(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}});
    }
    triangles = std::move(finer);
  }
  GridShape shape;
  const double half = radius * (1 + std::abs(bumpiness));
  shape.quantization.step = 2 * half / shape.quantization.maximum();
  for (size_t i = 0; i < 3; ++i) {
    shape.quantization.origin.at(i) = center.at(i) - half;
  }
  for (const Point& p : points) {
    const double wave = std::sin(7 * p[0]) * std::sin(6 * p[1] + 1) * std::sin(8 * p[2] + 2);
    const double r = radius * (1 + bumpiness * wave);
    shape.positions.push_back(shape.quantization.toGrid(
        {center[0] + r * p[0], center[1] + r * p[1], center[2] + r * p[2]}));
  }
  shape.triangles = std::move(triangles);
  return shape;
}

}  // namespace meshfront::testing
