// Bases for targets that need one: of real meshes, and one whose codes take nearly any bits.
#pragma once

#include <array>
#include <cmath>
#include <utility>

#include "encoder/pipeline/encode_mesh.h"
#include "shared/codec/base_mesh.h"
#include "tests/data/mesh_shapes.h"
#include "tests/unit/small_tables.h"

namespace meshfront::fuzz {

[[nodiscard]] inline PackContent encodedShape(IndexedMesh mesh, const char* name) {
  EncodeOptions options;
  options.name = name;
  options.quantizationBits = 10;
  options.baseFraction = 0.05;
  options.threads = 1;
  return std::move(encodeMesh(std::move(mesh), options).value().pack);
}

// Closed, with colours and normals.
[[nodiscard]] inline PackContent colouredTorus() {
  IndexedMesh mesh = torus(16, 10);
  for (const auto& p : mesh.positions) {
    const auto shade = [](double v) { return static_cast<uint8_t>(128 + 50 * std::sin(3 * v)); };
    mesh.colours.push_back({shade(p[0]), shade(p[1]), shade(p[2]), 255});
    mesh.normals.push_back(
        {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  }
  return encodedShape(std::move(mesh), "torus");
}

// With a boundary and a hole: virtual vertices; no attributes.
[[nodiscard]] inline PackContent sheetWithHole() {
  IndexedMesh mesh = gridPatchWithout(
      12, 12, [](uint32_t x, uint32_t y) { return x > 3 && x < 7 && y > 3 && y < 6; });
  for (auto& p : mesh.positions) p[2] = std::sin(p[0]) + std::cos(2 * p[1]);
  return encodedShape(std::move(mesh), "sheet");
}

[[nodiscard]] inline BaseMesh tetrahedronBase() {
  BaseMesh base;
  base.splitCount = 1000;
  base.roots.resize(4);
  for (size_t i = 0; i < 4; ++i) {
    base.roots[i].position = {8000, 8000, 8000};
    if (i < 3) base.roots[i].position[i] = 9000;
  }
  base.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  base.tables = smallTables();
  return base;
}

inline constexpr size_t kBases = 3;
[[nodiscard]] inline const BaseMesh& baseOf(size_t number) {
  static const std::array<BaseMesh, kBases> kAll{decodeBaseMesh(colouredTorus().base).value(),
                                                 decodeBaseMesh(sheetWithHole().base).value(),
                                                 tetrahedronBase()};
  return kAll[number % kBases];
}

}  // namespace meshfront::fuzz
