#include "viewer/export_mesh.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <vector>

#include "shared/mesh_files/mesh_files.h"

namespace meshfront {
namespace {

struct Exported {
  std::vector<std::array<double, 3>> positions;
  std::vector<Triangle> triangles;
  std::vector<Colour> colours;
  std::vector<std::array<float, 3>> normals;
};

void add(const GridMesh& front, const Quantization& quantization, const glm::dmat4& worldFromMesh,
         Exported& out) {
  const bool moved = worldFromMesh != glm::dmat4(1.0);  // else not a bit is to change
  const glm::dmat3 normalMatrix = glm::transpose(glm::inverse(glm::dmat3(worldFromMesh)));
  const auto first = static_cast<uint32_t>(out.positions.size());
  for (const GridPosition& position : front.positions) {
    std::array<double, 3> at = quantization.toWorld(position);
    if (moved) {
      const glm::dvec4 world = worldFromMesh * glm::dvec4(at[0], at[1], at[2], 1);
      at = {world.x, world.y, world.z};
    }
    out.positions.push_back(at);
  }
  // A mirror turns triangles round.
  const bool mirrored = moved && glm::determinant(glm::dmat3(worldFromMesh)) < 0;
  for (const Triangle& t : front.triangles) {
    Triangle corners{first + t[0], first + t[1], first + t[2]};
    if (mirrored) std::swap(corners[1], corners[2]);
    out.triangles.push_back(corners);
  }
  for (const VertexAttributes& a : front.attributes) {
    if (front.layout.colours) out.colours.push_back(a.colour);
    if (front.layout.normalBits == 0) continue;
    std::array<float, 3> normal = fromOctahedral(a.normal, front.layout.normalBits);
    if (moved) {
      const glm::dvec3 turned =
          glm::normalize(normalMatrix * glm::dvec3(normal[0], normal[1], normal[2]));
      normal = {static_cast<float>(turned.x), static_cast<float>(turned.y),
                static_cast<float>(turned.z)};
    }
    out.normals.push_back(normal);
  }
}

}  // namespace

Result<void> exportMesh(const SceneReceiver& scene, const std::filesystem::path& path) {
  Exported out;
  for (size_t i = 0; i < scene.meshCount(); ++i)
    if (const SelectivelyRefinedMesh* mesh = scene.receiver(i).mesh())
      add(mesh->snapshot(), scene.receiver(i).metadata()->quantization, scene.mesh(i).worldFromMesh,
          out);
  if (out.colours.size() != out.positions.size()) out.colours.clear();
  if (out.normals.size() != out.positions.size()) out.normals.clear();
  return writePly(path, out.positions, out.triangles, {out.colours, out.normals});
}

}  // namespace meshfront
