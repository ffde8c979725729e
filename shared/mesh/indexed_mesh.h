// A triangle mesh as files hold it: untouched coordinates, corners by index.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace meshfront {

using Triangle = std::array<uint32_t, 3>;  // vertex indices, counter-clockwise from outside

struct IndexedMesh {
  std::vector<std::array<double, 3>> positions;  // finite
  std::vector<Triangle> triangles;               // every index < positions.size()
};

}  // namespace meshfront
