#include "viewer/gl/mesh_arrays.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "shared/mesh/vertex_normals.h"

namespace meshfront {
namespace {

PackedNormal packedNormal(const OctahedralNormal& normal, unsigned bits) {
  const std::array<float, 3> unit = fromOctahedral(normal, bits);
  PackedNormal packed{};
  for (size_t i = 0; i < 3; ++i)
    packed[i] = static_cast<int16_t>(std::lround(double{unit[i]} * 32767));
  return packed;
}

}  // namespace

Result<MeshUpdate> updateFrom(const MeshArrays& mesh) {
  for (size_t t = 0; t < mesh.corners.size(); ++t) {
    const Triangle& c = mesh.corners[t];
    if (std::max({c[0], c[1], c[2]}) >= mesh.positions.size() && c != Triangle{})
      return fail("triangle " + std::to_string(t) + " has a corner beyond the " +
                  std::to_string(mesh.positions.size()) + " vertices");
  }
  if (mesh.positions.size() > INT32_MAX || mesh.corners.size() > INT32_MAX / 3)
    return fail(ErrorCode::tooLarge, "more than 715 million triangles cannot be drawn at once");
  for (const auto& [list, what] :
       {std::pair(mesh.coloured, " colours"), std::pair(mesh.normals, " normals")}) {
    if (!list.empty() && list.size() != mesh.positions.size())
      return fail("the mesh has " + std::to_string(list.size()) + what + " for " +
                  std::to_string(mesh.positions.size()) + " vertices");
  }
  std::vector<PackedNormal> normals;
  if (mesh.normals.empty()) computeVertexNormals(mesh.positions, mesh.corners, normals);
  MeshUpdate update;
  update.changeCount = mesh.changeCount;
  update.vertexSlots = mesh.positions.size();
  update.faceSlots = mesh.corners.size();
  update.slots.resize(mesh.positions.size());
  std::iota(update.slots.begin(), update.slots.end(), 0U);
  update.faces.resize(mesh.corners.size());
  std::iota(update.faces.begin(), update.faces.end(), 0U);
  update.corners.assign(mesh.corners.begin(), mesh.corners.end());
  update.vertices.resize(mesh.positions.size());
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    DrawnVertex& vertex = update.vertices[v];
    vertex.position = vertex.from = mesh.positions[v];
    vertex.normal =
        normals.empty() ? packedNormal(mesh.normals[v].normal, mesh.normalBits) : normals[v];
    if (!mesh.coloured.empty()) vertex.colour = mesh.coloured[v].colour;
    vertex.isLeaf = 1;
    vertex.node = static_cast<uint32_t>(v);
  }
  return update;
}

}  // namespace meshfront
