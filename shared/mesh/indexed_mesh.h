// A triangle mesh as files hold it: untouched coordinates, corners by index, what its vertices
// carry beside a position.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace meshfront {

using Triangle = std::array<uint32_t, 3>;  // vertex indices, counter-clockwise from outside
using Colour = std::array<uint8_t, 4>;     // red, green, blue, alpha; 255 is opaque

struct IndexedMesh {
  std::vector<std::array<double, 3>> positions;  // finite
  std::vector<Triangle> triangles;               // every index < positions.size()
  // Either empty or one a position.
  std::vector<Colour> colours{};
  std::vector<std::array<float, 3>> normals{};  // of any length, finite; 0 where there is none
  // What of the file's mesh is not here, a sentence each, for people; printable ASCII.
  std::vector<std::string> notCarried{};
};

}  // namespace meshfront
