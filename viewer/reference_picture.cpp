#include "viewer/reference_picture.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "shared/mesh_files/mesh_files.h"

namespace meshfront {
namespace {

// For each vertex the first one at its coordinates.
std::vector<uint32_t> firstAtSamePlace(const std::vector<std::array<double, 3>>& positions) {
  std::vector<uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&positions](uint32_t a, uint32_t b) {
    return positions[a] != positions[b] ? positions[a] < positions[b] : a < b;
  });
  std::vector<uint32_t> first(positions.size());
  for (size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && positions[order[i]] == positions[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

}  // namespace

Result<Picture> drawReference(const std::filesystem::path& meshFile, ScenePicture& picture,
                              const Camera& camera, bool colours, unsigned normalBits) {
  Result<IndexedMesh> mesh = readMesh(meshFile);
  if (!mesh) return tl::unexpected(mesh.error());
  const std::vector<uint32_t> first = firstAtSamePlace(mesh->positions);
  for (Triangle& triangle : mesh->triangles)
    for (uint32_t& corner : triangle) corner = first[corner];
  const Quantization fine = quantizationFor(mesh->positions, kMaxQuantizationBits);
  std::vector<GridPosition> grid;
  grid.reserve(mesh->positions.size());
  for (const auto& position : mesh->positions) grid.push_back(fine.toGrid(position));
  // As cleaning gives them: those of the first of the vertices at one place.
  const unsigned bits = mesh->normals.empty() ? 0 : normalBits;
  const auto carried = packAttributes(mesh->colours, mesh->normals, {!mesh->colours.empty(), bits});
  MeshArrays arrays{fine, grid, mesh->triangles, 1};
  if (!mesh->colours.empty()) arrays.coloured = carried;
  if (bits != 0) arrays.normals = carried;
  arrays.normalBits = bits;
  DrawStyle style;
  style.colours = colours;
  return picture.drawOther(arrays, camera, style);
}

}  // namespace meshfront
