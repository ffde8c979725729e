// write-nasty-meshes DIR: the nasty meshes as PLY files, to run programs over them.
#include <cstdio>

#include "shared/mesh_files/mesh_files.h"
#include "tests/data/nasty_meshes.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: write-nasty-meshes DIR\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  for (const meshfront::NastyMesh& nasty : meshfront::nastyMeshes()) {
    const auto path = folder / (nasty.name + ".ply");
    const meshfront::IndexedMesh& mesh = nasty.mesh;
    const auto written =
        meshfront::writePly(path, mesh.positions, mesh.triangles, {mesh.colours, mesh.normals});
    if (!written) {
      std::fprintf(stderr, "write-nasty-meshes: %s\n", written.error().message.c_str());
      return 1;
    }
    std::printf("%s\n", path.c_str());
  }
  return 0;
}
