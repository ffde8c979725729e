// Bases for targets that need one: two of the seeds of the target "base", which are real meshes,
// and one whose codes take nearly any bits.
#pragma once

#include <array>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "shared/bits/crc32c.h"
#include "shared/codec/base_mesh.h"
#include "tests/unit/small_tables.h"

namespace meshfront::fuzz {

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

// The seed of that name. If it is of another version of the format, the tetrahedron stands in: the
// tests of the seeds say what to do.
[[nodiscard]] inline BaseMesh baseInSeed(const std::string& name) {
  std::ifstream in(MESHFRONT_FUZZ_CORPUS "/base/" + name, std::ios::binary);
  std::vector<uint8_t> bytes{std::istreambuf_iterator<char>(in), {}};
  appendChecksum(bytes);
  auto base = decodeBaseMesh(bytes);
  return base ? std::move(*base) : tetrahedronBase();
}

inline constexpr size_t kBases = 3;
[[nodiscard]] inline const BaseMesh& baseOf(size_t number) {
  static const std::array<BaseMesh, kBases> kAll{
      baseInSeed("valid-coloured-torus"), baseInSeed("valid-sheet-with-hole"), tetrahedronBase()};
  return kAll[number % kBases];
}

}  // namespace meshfront::fuzz
