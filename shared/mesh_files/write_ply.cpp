#include <algorithm>
#include <bit>
#include <cstring>
#include <string>

#include "shared/mesh_files/file_bytes.h"
#include "shared/mesh_files/mesh_files.h"
#include "shared/mesh_files/mesh_readers.h"

namespace meshfront {
namespace {

static_assert(std::endian::native == std::endian::little,
              "the codec's platforms are little-endian; add a byte swap here for another");

template <typename T>
char* put(char* at, T value) {
  std::memcpy(at, &value, sizeof value);
  return at + sizeof value;
}

}  // namespace

Result<void> writePly(const std::filesystem::path& path,
                      std::span<const std::array<double, 3>> positions,
                      std::span<const Triangle> triangles, const PlyVertexAttributes& attributes) {
  if (positions.size() > kMaxFileVertices || triangles.size() > kMaxFileVertices)
    return fail(ErrorCode::tooLarge, path.string() + ": too large for a PLY file's int indices");
  const bool colours = !attributes.colours.empty();
  const bool normals = !attributes.normals.empty();
  if ((colours && attributes.colours.size() != positions.size()) ||
      (normals && attributes.normals.size() != positions.size()))
    return fail(path.string() + ": not as many colours or normals as vertices");
  for (const Triangle& t : triangles) {
    const uint32_t largest = std::max({t[0], t[1], t[2]});
    if (largest >= positions.size())
      return fail(path.string() + ": " + indexOutOfRange(largest, positions.size()));
  }
  std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                       std::to_string(positions.size()) +
                       "\nproperty double x\nproperty double y\nproperty double z\n";
  if (normals) header += "property float nx\nproperty float ny\nproperty float nz\n";
  if (colours)
    header +=
        "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";
  header += "element face " + std::to_string(triangles.size()) +
            "\nproperty list uchar int vertex_indices\nend_header\n";
  const size_t vertexBytes = 24 + (normals ? 12U : 0U) + (colours ? 4U : 0U);
  std::string file(header.size() + positions.size() * vertexBytes + triangles.size() * 13, '\0');
  char* at = std::copy(header.begin(), header.end(), file.data());
  for (size_t vertex = 0; vertex < positions.size(); ++vertex) {
    at = put(at, positions[vertex]);
    if (normals) at = put(at, attributes.normals[vertex]);
    if (colours) at = put(at, attributes.colours[vertex]);
  }
  for (const Triangle& t : triangles) {
    at = put(at, uint8_t{3});
    for (const uint32_t corner : t) at = put(at, corner);
  }
  return replaceFileBytes(path, file);
}

}  // namespace meshfront
