// Object File Format (Geomview), ASCII. One vertex and one face a line; columns behind what we need
// (normals, colours, texture coordinates) are skipped with the rest of the line.
#include <array>
#include <vector>

#include "shared/mesh_files/mesh_readers.h"
#include "shared/mesh_files/polygon_triangles.h"
#include "shared/mesh_files/text_cursor.h"

namespace meshfront {
namespace {

// [ST][C][N]OFF. 4OFF and nOFF have other dimensions.
bool isOffKeyword(std::string_view word) {
  for (const std::string_view prefix : {"ST", "C", "N"})
    if (word.starts_with(prefix)) word.remove_prefix(prefix.size());
  return word == "OFF";
}

Result<void> readKeyword(TextCursor& text) {
  text.skipSpaceAndComments();
  const std::string_view word = text.peekWord();
  if (!word.ends_with("OFF")) return {};  // the keyword may be left out
  if (!isOffKeyword(word))
    return fail(text.place() +
                ": only OFF with three coordinates is read (OFF, COFF, NOFF, STOFF)");
  text.word();
  text.skipBlanks();
  if (text.peekWord() == "BINARY")
    return fail(text.place() + ": binary OFF is not read; convert the file to PLY");
  return {};
}

Result<std::array<uint64_t, 2>> readCounts(TextCursor& text) {
  std::array<uint64_t, 2> counts{};
  for (uint64_t& count : counts) {
    text.skipSpaceAndComments();
    const TextCursor before = text;
    int64_t value = 0;
    if (!text.integer(value) || value < 0) return fail(before.problem("count"));
    count = static_cast<uint64_t>(value);
  }
  text.skipLine();  // the number of edges, which nobody needs
  // A vertex takes at least six bytes ("0 0 0\n"), a face two ("0\n"), the last one no line end.
  if (counts[0] > (text.left() + 1) / 6 || counts[1] > (text.left() + 1) / 2)
    return fail(text.place(text.offset() + text.left()) + ": the file ends early, it promises " +
                std::to_string(counts[0]) + " vertices and " + std::to_string(counts[1]) +
                " faces");
  if (counts[0] > kMaxFileVertices)
    return fail(ErrorCode::tooLarge, text.place() + ": more than 2^31 - 1 vertices");
  return counts;
}

}  // namespace

Result<IndexedMesh> readOff(std::string_view file) {
  TextCursor text(file);
  if (auto keyword = readKeyword(text); !keyword) return tl::unexpected(keyword.error());
  const auto counts = readCounts(text);
  if (!counts) return tl::unexpected(counts.error());

  IndexedMesh mesh;
  mesh.positions.resize((*counts)[0]);
  for (auto& position : mesh.positions) {
    for (double& coordinate : position) {
      text.skipSpaceAndComments();
      if (!text.real(coordinate)) return fail(text.problem());
    }
    text.skipLine();
  }
  mesh.triangles.reserve((*counts)[1]);
  std::vector<uint32_t> corners;
  for (uint64_t face = 0; face < (*counts)[1]; ++face) {
    text.skipSpaceAndComments();
    const TextCursor before = text;
    int64_t length = 0;
    if (!text.integer(length) || length < 0) return fail(before.problem("number of corners"));
    corners.clear();
    for (int64_t i = 0; i < length; ++i) {
      text.skipSpaceAndComments();
      int64_t index = 0;
      if (!text.integer(index)) return fail(text.problem("vertex index"));
      if (index < 0 || index >= static_cast<int64_t>(mesh.positions.size()))
        return fail(text.place() + ": " + indexOutOfRange(index, mesh.positions.size()));
      corners.push_back(static_cast<uint32_t>(index));
    }
    text.skipLine();
    appendFan(corners, mesh.triangles);
  }
  return mesh;
}

}  // namespace meshfront
