#include <cmath>

#include "shared/mesh_files/decompress.h"
#include "shared/mesh_files/mesh_files.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/fuzz/promise.h"

namespace meshfront::fuzz {
namespace {

std::string_view textOf(Bytes input) {
  return {reinterpret_cast<const char*>(input.data()), input.size()};
}

bool readFile(Bytes input, MeshFormat format) {
  const auto mesh = parseMesh(textOf(input), format);
  if (!mesh) {
    promise(!mesh.error().message.empty(), "an error says what is wrong");
    return false;
  }
  promise(!mesh->triangles.empty(), "there is a triangle");
  for (const auto& position : mesh->positions)
    for (const double v : position) promise(std::isfinite(v), "coordinates are finite");
  for (const Triangle& triangle : mesh->triangles)
    for (const uint32_t corner : triangle)
      promise(corner < mesh->positions.size(), "corners are in range");
  for (const size_t count : {mesh->colours.size(), mesh->normals.size()})
    promise(count == 0 || count == mesh->positions.size(), "attributes for all or none");
  for (const auto& normal : mesh->normals)
    for (const float v : normal) promise(std::isfinite(v), "normals are finite");
  for (const std::string& sentence : mesh->notCarried)
    for (const char c : sentence) promise(c >= ' ' && c <= '~', "sentences are printable");
  return true;
}

}  // namespace

bool readPlyFile(Bytes input) {
  return readFile(input, MeshFormat::ply);
}
bool readObjFile(Bytes input) {
  return readFile(input, MeshFormat::obj);
}
bool readStlFile(Bytes input) {
  return readFile(input, MeshFormat::stl);
}
bool readOffFile(Bytes input) {
  return readFile(input, MeshFormat::off);
}
bool readGltfFile(Bytes input) {
  return readFile(input, MeshFormat::gltf);
}
bool readGlbFile(Bytes input) {
  return readFile(input, MeshFormat::gltf);
}

bool decompressFile(Bytes input) {
  constexpr uint64_t kLimit = 1 << 20;
  const auto file = textOf(input);
  const Compression compression = compressionOf(file);
  if (compression == Compression::none) return false;
  const auto content = decompress(file, compression, kLimit);
  if (content) promise(content->size() <= kLimit, "no more than the limit comes out");
  return content.has_value();
}

}  // namespace meshfront::fuzz
