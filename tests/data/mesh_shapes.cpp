#include "tests/data/mesh_shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace meshfront {

IndexedMesh gridPatch(uint32_t columns, uint32_t rows) {
  return gridPatchWithout(columns, rows, [](uint32_t, uint32_t) { return false; });
}

IndexedMesh gridPatchWithout(uint32_t columns, uint32_t rows,
                             const std::function<bool(uint32_t, uint32_t)>& hole) {
  IndexedMesh mesh;
  for (uint32_t y = 0; y <= rows; ++y)
    for (uint32_t x = 0; x <= columns; ++x)
      mesh.positions.push_back({static_cast<double>(x), static_cast<double>(y), 0});
  for (uint32_t y = 0; y < rows; ++y) {
    for (uint32_t x = 0; x < columns; ++x) {
      if (hole(x, y)) continue;
      const uint32_t corner = y * (columns + 1) + x;
      const uint32_t above = corner + columns + 1;
      mesh.triangles.push_back({corner, corner + 1, above + 1});
      mesh.triangles.push_back({corner, above + 1, above});
    }
  }
  return mesh;
}

IndexedMesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
          {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

IndexedMesh torus(uint32_t around, uint32_t tube) {
  IndexedMesh mesh;
  for (uint32_t i = 0; i < around; ++i) {
    const double a = 2 * std::numbers::pi * i / around;
    for (uint32_t j = 0; j < tube; ++j) {
      const double b = 2 * std::numbers::pi * j / tube;
      const double radius = 2 + 0.7 * std::cos(b);
      mesh.positions.push_back({radius * std::cos(a), radius * std::sin(a), 0.7 * std::sin(b)});
    }
  }
  for (uint32_t i = 0; i < around; ++i) {
    for (uint32_t j = 0; j < tube; ++j) {
      const uint32_t here = i * tube + j;
      const uint32_t next = (i + 1) % around * tube + j;
      const uint32_t hereUp = i * tube + (j + 1) % tube;
      const uint32_t nextUp = (i + 1) % around * tube + (j + 1) % tube;
      mesh.triangles.push_back({here, next, nextUp});
      mesh.triangles.push_back({here, nextUp, hereUp});
    }
  }
  return mesh;
}

IndexedMesh sphere(unsigned times) {
  IndexedMesh mesh{
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  for (; times > 0; --times) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
    const auto middle = [&](uint32_t a, uint32_t b) {
      const auto [found, added] =
          middles.try_emplace(std::minmax(a, b), static_cast<uint32_t>(mesh.positions.size()));
      if (added) {
        std::array<double, 3> sum{};
        for (size_t i = 0; i < 3; ++i) sum[i] = mesh.positions[a][i] + mesh.positions[b][i];
        const double length = std::hypot(sum[0], sum[1], sum[2]);
        mesh.positions.push_back({sum[0] / length, sum[1] / length, sum[2] / length});
      }
      return found->second;
    };
    std::vector<Triangle> finer;
    for (const Triangle& t : mesh.triangles) {
      const uint32_t ab = middle(t[0], t[1]);
      const uint32_t bc = middle(t[1], t[2]);
      const uint32_t ca = middle(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

IndexedMesh cubesSurface(const std::array<int, 3>& size,
                         const std::function<bool(const std::array<int, 3>&)>& filled) {
  IndexedMesh mesh;
  std::map<std::array<int, 3>, uint32_t> vertices;
  const auto vertexAt = [&](const std::array<int, 3>& p) {
    const auto [found, added] =
        vertices.try_emplace(p, static_cast<uint32_t>(mesh.positions.size()));
    if (added) mesh.positions.push_back({double(p[0]), double(p[1]), double(p[2])});
    return found->second;
  };
  const auto isFilled = [&](const std::array<int, 3>& cube) {
    for (size_t i = 0; i < 3; ++i)
      if (cube[i] < 0 || cube[i] >= size[i]) return false;
    return filled(cube);
  };
  const auto addSide = [&](const std::array<int, 3>& cube, size_t axis, bool positive) {
    std::array<int, 3> corner = cube;
    corner[axis] += positive ? 1 : 0;
    const size_t right = (axis + 1) % 3;
    const size_t up = (axis + 2) % 3;
    std::array<uint32_t, 4> quad{};
    for (size_t i = 0; i < 4; ++i) {
      std::array<int, 3> p = corner;
      p[right] += i == 1 || i == 2 ? 1 : 0;
      p[up] += i >= 2 ? 1 : 0;
      quad[i] = vertexAt(p);
    }
    if (!positive) std::swap(quad[1], quad[3]);
    mesh.triangles.push_back({quad[0], quad[1], quad[2]});
    mesh.triangles.push_back({quad[0], quad[2], quad[3]});
  };
  std::array<int, 3> cube{};
  for (cube[2] = 0; cube[2] < size[2]; ++cube[2])
    for (cube[1] = 0; cube[1] < size[1]; ++cube[1])
      for (cube[0] = 0; cube[0] < size[0]; ++cube[0])
        for (size_t axis = 0; axis < 3; ++axis)
          for (const bool positive : {false, true}) {
            std::array<int, 3> beside = cube;
            beside[axis] += positive ? 1 : -1;
            if (isFilled(cube) && !isFilled(beside)) addSide(cube, axis, positive);
          }
  return mesh;
}

void appendMesh(IndexedMesh& mesh, const IndexedMesh& part, const std::array<double, 3>& offset) {
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  for (const auto& p : part.positions)
    mesh.positions.push_back({p[0] + offset[0], p[1] + offset[1], p[2] + offset[2]});
  for (const Triangle& t : part.triangles)
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

}  // namespace meshfront
