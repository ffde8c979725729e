// STL: triangles without shared vertices, in text or in records of 50 bytes (little-endian).
#include <bit>
#include <cstring>
#include <vector>

#include "shared/mesh/weld_positions.h"
#include "shared/mesh_files/mesh_readers.h"
#include "shared/mesh_files/not_carried.h"
#include "shared/mesh_files/text_cursor.h"

namespace meshfront {
namespace {

static_assert(std::endian::native == std::endian::little, "add byte swaps for another platform");

constexpr size_t kBinaryHeader = 84;  // 80 bytes of free text, then the number of triangles
constexpr size_t kBinaryTriangle = 50;
constexpr size_t kNormal = 12;

uint64_t binaryTriangleCount(std::string_view file) {
  uint32_t count = 0;
  std::memcpy(&count, file.data() + kBinaryHeader - sizeof count, sizeof count);
  return count;
}

// Three corners each, in order, become triangles on welded vertices.
Result<IndexedMesh> weldCorners(std::string_view file,
                                const std::vector<std::array<double, 3>>& corners) {
  if (corners.empty()) return noTriangles(file, "no facets");
  auto welded = weldPositions(corners);
  IndexedMesh mesh;
  mesh.positions = std::move(welded.positions);
  mesh.positions.shrink_to_fit();
  mesh.triangles.reserve(corners.size() / 3);
  for (size_t i = 0; i + 2 < corners.size(); i += 3)
    mesh.triangles.push_back({welded.indexOf[i], welded.indexOf[i + 1], welded.indexOf[i + 2]});
  return mesh;
}

Result<IndexedMesh> readBinaryStl(std::string_view file) {
  if (file.size() < kBinaryHeader)
    return fail("byte " + std::to_string(file.size()) + ": the file ends within the STL header");
  const uint64_t count = binaryTriangleCount(file);
  if (count > (file.size() - kBinaryHeader) / kBinaryTriangle)
    return fail("byte " + std::to_string(file.size()) + ": the file ends early, it promises " +
                std::to_string(count) + " triangles");
  if (count * 3 > kMaxFileVertices)
    return fail(ErrorCode::tooLarge, "byte 80: more than 2^31 / 3 triangles");
  std::vector<std::array<double, 3>> corners(count * 3);
  for (size_t i = 0; i < corners.size(); ++i) {
    const size_t at = kBinaryHeader + i / 3 * kBinaryTriangle + kNormal + i % 3 * 12;
    std::array<float, 3> corner{};
    std::memcpy(corner.data(), file.data() + at, sizeof corner);
    for (size_t axis = 0; axis < 3; ++axis) {
      if (!std::isfinite(corner[axis]))
        return fail("byte " + std::to_string(at + axis * 4) + ": a coordinate that is not finite");
      corners[i][axis] = corner[axis];
    }
  }
  uint64_t facetsWithAttributes = 0;  // some programs keep a colour there, each another way
  for (uint64_t i = 1; i <= count; ++i) {
    uint16_t attribute = 0;
    std::memcpy(&attribute, file.data() + kBinaryHeader + i * kBinaryTriangle - sizeof attribute,
                sizeof attribute);
    if (attribute != 0) ++facetsWithAttributes;
  }
  auto mesh = weldCorners(file, corners);
  if (mesh) addNotCarried(mesh->notCarried, "facets with attribute bytes", facetsWithAttributes);
  return mesh;
}

Result<IndexedMesh> readAsciiStl(std::string_view file) {
  TextCursor text(file);
  std::vector<std::array<double, 3>> corners;
  std::vector<std::array<double, 3>> facet;
  bool inSolid = false;
  for (text.skipSpace(); !text.atEnd(); text.skipSpace()) {
    const std::string_view word = text.peekWord();
    if (word == "vertex") {
      text.word();
      auto& corner = facet.emplace_back();
      for (double& coordinate : corner) {
        text.skipSpace();
        if (!text.real(coordinate)) return fail(text.problem());
      }
    } else if (word == "endloop") {
      if (facet.size() < 3) return fail(text.place() + ": a facet with fewer than three vertices");
      for (size_t i = 2; i < facet.size(); ++i)
        corners.insert(corners.end(), {facet[0], facet[i - 1], facet[i]});
      facet.clear();
      text.word();
    } else if (word == "endfacet") {
      text.word();
    } else if (word == "solid" || word == "endsolid") {
      inSolid = word == "solid";
      text.skipLine();  // a name of any words follows
    } else if (word == "facet" || word == "outer") {
      text.skipLine();  // the normal, which may be anything; "loop"
    } else {
      return fail(text.problem("STL keyword (solid, facet, outer, vertex, endloop, endfacet)"));
    }
    if (corners.size() > kMaxFileVertices)
      return fail(ErrorCode::tooLarge, text.place() + ": more than 2^31 / 3 triangles");
  }
  if (inSolid || !facet.empty()) return fail(text.problem());
  return weldCorners(file, corners);
}

}  // namespace

bool looksLikeBinaryStl(std::string_view file) {
  return file.size() >= kBinaryHeader &&
         file.size() == kBinaryHeader + binaryTriangleCount(file) * kBinaryTriangle;
}

Result<IndexedMesh> readStl(std::string_view file) {
  // Many a binary file starts with "solid" too, so the size decides first.
  if (looksLikeBinaryStl(file)) return readBinaryStl(file);
  TextCursor text(file);
  text.skipSpace();
  if (text.word() != "solid") return readBinaryStl(file);
  // Neither does a binary file with something behind its triangles name a facet soon.
  const std::string_view head = file.substr(0, 2048);
  const bool isText = head.find("facet") != head.npos || head.find("endsolid") != head.npos ||
                      head.find('\0') == head.npos;
  return isText ? readAsciiStl(file) : readBinaryStl(file);
}

}  // namespace meshfront
