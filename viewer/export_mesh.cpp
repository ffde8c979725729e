#include "viewer/export_mesh.h"

#include <vector>

#include "shared/mesh_files/mesh_files.h"

namespace meshfront {

Result<void> exportMesh(const SelectivelyRefinedMesh& mesh, const Quantization& quantization,
                        const std::filesystem::path& path) {
  const GridMesh snapshot = mesh.snapshot();
  std::vector<std::array<double, 3>> world;
  world.reserve(snapshot.positions.size());
  for (const GridPosition& position : snapshot.positions)
    world.push_back(quantization.toWorld(position));
  std::vector<Colour> colours;
  std::vector<std::array<float, 3>> normals;
  for (const VertexAttributes& a : snapshot.attributes) {
    if (snapshot.layout.colours) colours.push_back(a.colour);
    if (snapshot.layout.normalBits != 0)
      normals.push_back(fromOctahedral(a.normal, snapshot.layout.normalBits));
  }
  return writePly(path, world, snapshot.triangles, {colours, normals});
}

}  // namespace meshfront
