// The readers behind readMesh(), one a format. Input is untrusted; Errors name the line or byte,
// not the file. A mesh without a single triangle is an Error that says why.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "shared/mesh/indexed_mesh.h"
#include "shared/result.h"

namespace meshfront {

inline constexpr size_t kMaxFileVertices = INT32_MAX;

[[nodiscard]] Result<IndexedMesh> readPly(std::string_view file);
[[nodiscard]] Result<IndexedMesh> readObj(std::string_view file);
[[nodiscard]] Result<IndexedMesh> readStl(std::string_view file);
[[nodiscard]] Result<IndexedMesh> readOff(std::string_view file);
// Buffers in other files are read from `folder`, or below it, and are Errors without one.
[[nodiscard]] Result<IndexedMesh> readGltf(std::string_view file,
                                           const std::optional<std::filesystem::path>& folder);

// A binary STL file has no magic number; this is true if its size fits its triangle count.
[[nodiscard]] bool looksLikeBinaryStl(std::string_view file);

// The Error of a file without a triangle; `why` is what it has instead ("3 vertices and no faces").
[[nodiscard]] inline tl::unexpected<Error> noTriangles(std::string_view file,
                                                       const std::string& why) {
  return fail("byte " + std::to_string(file.size()) +
              ": the file ends without a single triangle: it has " + why);
}
// "1 vertex", "3 vertices".
[[nodiscard]] inline std::string counted(uint64_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

// What one says of an index that is too large, in every format.
[[nodiscard]] inline std::string indexOutOfRange(long long index, size_t vertexCount) {
  return "vertex index " + std::to_string(index) + " is out of range, there are " +
         std::to_string(vertexCount) + " vertices";
}

}  // namespace meshfront
