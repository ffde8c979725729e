#include "shared/mesh_files/mesh_files.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "shared/mesh_files/available_memory.h"
#include "shared/mesh_files/decompress.h"
#include "shared/mesh_files/file_bytes.h"
#include "shared/mesh_files/file_extension.h"
#include "shared/mesh_files/mesh_readers.h"
#include "shared/mesh_files/text_cursor.h"

namespace meshfront {
namespace {

std::optional<MeshFormat> formatByExtension(const std::filesystem::path& path) {
  const std::string extension = lowerCaseExtension(path);
  if (extension == ".ply") return MeshFormat::ply;
  if (extension == ".obj") return MeshFormat::obj;
  if (extension == ".stl") return MeshFormat::stl;
  if (extension == ".off") return MeshFormat::off;
  if (extension == ".gltf" || extension == ".glb") return MeshFormat::gltf;
  return std::nullopt;
}

std::optional<MeshFormat> formatByContent(std::string_view file) {
  TextCursor text(file);
  const std::string_view first = text.word();
  if (first == "ply") return MeshFormat::ply;
  if (file.starts_with("glTF")) return MeshFormat::gltf;
  if (looksLikeBinaryStl(file)) return MeshFormat::stl;
  text = TextCursor(file);
  text.skipSpaceAndComments();
  const std::string_view word = text.word();
  if (word.starts_with('{')) return MeshFormat::gltf;
  if (word == "solid") return MeshFormat::stl;
  if (word.size() <= 8 && word.ends_with("OFF")) return MeshFormat::off;
  constexpr std::array<std::string_view, 9> kObjWords = {"v", "vt", "vn", "f",     "g",
                                                         "o", "s",  "l",  "mtllib"};
  if (std::find(kObjWords.begin(), kObjWords.end(), word) != kObjWords.end())
    return MeshFormat::obj;
  return std::nullopt;
}

constexpr uint64_t kMostDecompressed = uint64_t{64} << 30;

// The file's content, decompressed, and its name without that of the compression.
Result<std::string> contentOf(const std::filesystem::path& path, std::filesystem::path& name) {
  auto content = readFileBytes(path);
  if (!content) return content;
  const Compression named = compressionNamed(path);
  if (named != Compression::none) name.replace_extension();
  const Compression compression = compressionOf(*content);
  if (compression == Compression::none) {
    if (named != Compression::none && !formatByContent(*content))
      return fail(path.string() + ": byte 0: neither a " + nameOf(named) + " file nor a mesh");
    return content;
  }
  auto decompressed =
      decompress(*content, compression, std::min(kMostDecompressed, availableMemory().bytes));
  if (!decompressed)
    return fail(decompressed.error().code, path.string() + ": " + decompressed.error().message);
  return decompressed;
}

}  // namespace

Result<IndexedMesh> parseMesh(std::string_view content, MeshFormat format,
                              const std::optional<std::filesystem::path>& folder) {
  switch (format) {
    case MeshFormat::ply:
      return readPly(content);
    case MeshFormat::obj:
      return readObj(content);
    case MeshFormat::stl:
      return readStl(content);
    case MeshFormat::off:
      return readOff(content);
    case MeshFormat::gltf:
      return readGltf(content, folder);
  }
  return fail("unknown format");
}

Result<IndexedMesh> readMesh(const std::filesystem::path& path) {
  std::filesystem::path name = path;
  const auto content = contentOf(path, name);
  if (!content) return tl::unexpected(content.error());
  auto format = formatByExtension(name);
  if (!format) format = formatByContent(*content);
  if (!format)
    return fail(path.string() +
                ": byte 0: not a mesh file; PLY, OBJ, STL, OFF and glTF are read (extension or "
                "content)");
  auto mesh = parseMesh(*content, *format, path.has_parent_path() ? path.parent_path() : ".");
  if (!mesh) return fail(mesh.error().code, path.string() + ": " + mesh.error().message);
  return mesh;
}

}  // namespace meshfront
