#include "shared/mesh_files/mesh_files.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "shared/mesh_files/file_bytes.h"
#include "shared/mesh_files/mesh_readers.h"
#include "shared/mesh_files/text_cursor.h"

namespace meshfront {
namespace {

std::optional<MeshFormat> formatByExtension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (extension == ".ply") return MeshFormat::ply;
  if (extension == ".obj") return MeshFormat::obj;
  if (extension == ".stl") return MeshFormat::stl;
  if (extension == ".off") return MeshFormat::off;
  return std::nullopt;
}

std::optional<MeshFormat> formatByContent(std::string_view file) {
  TextCursor text(file);
  const std::string_view first = text.word();
  if (first == "ply") return MeshFormat::ply;
  if (looksLikeBinaryStl(file)) return MeshFormat::stl;
  text = TextCursor(file);
  text.skipSpaceAndComments();
  const std::string_view word = text.word();
  if (word == "solid") return MeshFormat::stl;
  if (word.size() <= 8 && word.ends_with("OFF")) return MeshFormat::off;
  constexpr std::array<std::string_view, 9> kObjWords = {"v", "vt", "vn", "f",     "g",
                                                         "o", "s",  "l",  "mtllib"};
  if (std::find(kObjWords.begin(), kObjWords.end(), word) != kObjWords.end())
    return MeshFormat::obj;
  return std::nullopt;
}

}  // namespace

Result<IndexedMesh> parseMesh(std::string_view content, MeshFormat format) {
  Result<IndexedMesh> mesh = fail("unknown format");
  switch (format) {
    case MeshFormat::ply:
      mesh = readPly(content);
      break;
    case MeshFormat::obj:
      mesh = readObj(content);
      break;
    case MeshFormat::stl:
      mesh = readStl(content);
      break;
    case MeshFormat::off:
      mesh = readOff(content);
      break;
  }
  return mesh;
}

Result<IndexedMesh> readMesh(const std::filesystem::path& path) {
  const auto content = readFileBytes(path);
  if (!content) return tl::unexpected(content.error());
  auto format = formatByExtension(path);
  if (!format) format = formatByContent(*content);
  if (!format)
    return fail(path.string() +
                ": byte 0: not a mesh file; PLY, OBJ, STL and OFF are read (extension or content)");
  auto mesh = parseMesh(*content, *format);
  if (!mesh) return fail(mesh.error().code, path.string() + ": " + mesh.error().message);
  return mesh;
}

}  // namespace meshfront
