// write-plain-ply INPUT OUTPUT: any mesh file as the plainest PLY, which every program reads:
// binary, floats, triangles.
#include <bit>
#include <cstdio>
#include <fstream>

#include "shared/mesh_files/mesh_files.h"

namespace {

template <typename Number>
void put(std::ofstream& file, Number number) {
  static_assert(std::endian::native == std::endian::little);
  file.write(reinterpret_cast<const char*>(&number), sizeof number);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: write-plain-ply INPUT OUTPUT\n");
    return 2;
  }
  const auto mesh = meshfront::readMesh(argv[1]);
  if (!mesh) {
    std::fprintf(stderr, "write-plain-ply: %s\n", mesh.error().message.c_str());
    return 1;
  }
  std::ofstream file(argv[2], std::ios::binary);
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh->positions.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
       << mesh->triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const auto& position : mesh->positions)
    for (const double coordinate : position) put(file, static_cast<float>(coordinate));
  for (const auto& triangle : mesh->triangles) {
    put(file, uint8_t{3});
    for (const uint32_t corner : triangle) put(file, corner);
  }
  file.close();
  if (!file) {
    std::fprintf(stderr, "write-plain-ply: %s cannot be written\n", argv[2]);
    return 1;
  }
  return 0;
}
