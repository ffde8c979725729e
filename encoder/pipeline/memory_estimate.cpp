#include "encoder/pipeline/memory_estimate.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

#include "shared/mesh_files/ply_header.h"

namespace meshfront {

namespace {

constexpr uint64_t kProgram = uint64_t{8} << 20;  // code, libraries, threads
constexpr std::streamsize kHeaderBytes = 65536;
constexpr uint64_t kStlHeaderBytes = 84;
constexpr uint64_t kStlTriangleBytes = 50;

bool sharesNoVertices(const MeshSize& size) {
  return size.vertices > 2 * size.triangles;
}

bool has(const PlyElement& element, std::string_view property) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [&](const PlyProperty& p) { return p.name == property; });
}

MeshSize inPly(const PlyHeader& header, uint64_t fileBytes) {
  MeshSize size;
  for (const PlyElement& element : header.elements) {
    uint64_t bytesEach = 0;
    for (const PlyProperty& property : element.properties)
      bytesEach += header.encoding == PlyEncoding::ascii
                       ? 2
                       : byteLength(property.countType.value_or(property.type));
    const uint64_t count = std::min(element.count, fileBytes / std::max<uint64_t>(bytesEach, 1));
    if (element.name == "vertex") {
      size.vertices = count;
      size.colours = has(element, "red");
      size.normals = has(element, "nx");
    }
    if (element.name == "face") size.triangles = count;
  }
  // Polygons and strips become more triangles than there are rows.
  if (size.triangles < size.vertices) size.triangles = 2 * size.vertices;
  return size;
}

}  // namespace

uint64_t MemoryEstimate::peak() const {
  return std::max({read, clean, simplify, hierarchy, code});
}

MemoryEstimate estimateMemory(const MeshSize& size, uint64_t fileBytes) {
  const uint64_t f = size.triangles;
  const uint64_t input = size.vertices;
  // About half as many vertices as triangles are left when corners have been welded.
  const uint64_t v = sharesNoVertices(size) ? f / 2 : input;
  const uint64_t welding = sharesNoVertices(size) ? 20 * input : 0;
  const uint64_t readAttributes = (size.colours ? 4 : 0) + (size.normals ? 12 : 0);
  const uint64_t attributes = readAttributes > 0 ? 8 * v : 0;
  MemoryEstimate out;
  out.read = kProgram + fileBytes + (24 + readAttributes) * input + 12 * f + welding;
  out.clean = kProgram + readAttributes * input +
              std::max(28 * input + 28 * v + 54 * f, 44 * input + 24 * v + 12 * f);
  out.simplify =
      kProgram + 12 * v + 12 * f + attributes + std::max(16 * v + 84 * f, 96 * v + 48 * f);
  out.hierarchy = kProgram + 92 * v + 12 * f + attributes;
  out.code = kProgram + 110 * v + 42 * f + attributes;
  return out;
}

std::optional<MeshSize> promisedSize(const std::filesystem::path& path) {
  std::error_code problem;
  if (!std::filesystem::is_regular_file(path, problem)) return std::nullopt;
  const uint64_t fileBytes = std::filesystem::file_size(path, problem);
  if (problem) return std::nullopt;
  std::string head(static_cast<size_t>(kHeaderBytes), '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), kHeaderBytes);
  head.resize(static_cast<size_t>(file.gcount()));
  if (head.starts_with("ply")) {
    const auto header = parsePlyHeader(head);
    if (!header) return std::nullopt;
    return inPly(*header, fileBytes);
  }
  if (head.size() < kStlHeaderBytes) return std::nullopt;
  uint32_t triangles = 0;
  std::memcpy(&triangles, head.data() + kStlHeaderBytes - sizeof triangles, sizeof triangles);
  if (fileBytes != kStlHeaderBytes + kStlTriangleBytes * uint64_t{triangles}) return std::nullopt;
  return MeshSize{uint64_t{3} * triangles, triangles};
}

}  // namespace meshfront
