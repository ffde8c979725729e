#include "viewer/export_mesh.h"

#include <vector>

#include "shared/mesh_files/mesh_files.h"

namespace meshfront {

Result<void> exportMesh(const SelectivelyRefinedMesh& mesh, const Quantization& quantization,
                        const std::filesystem::path& path) {
  const SelectivelyRefinedMesh::Snapshot snapshot = mesh.snapshot();
  std::vector<std::array<double, 3>> world;
  world.reserve(snapshot.positions.size());
  for (const GridPosition& position : snapshot.positions)
    world.push_back(quantization.toWorld(position));
  return writePly(path, world, snapshot.triangles);
}

}  // namespace meshfront
