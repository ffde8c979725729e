// Reads triangle meshes from PLY, OBJ, STL and OFF files, and writes PLY.
//
//   auto mesh = readMesh("bunny.ply");
//   if (!mesh) return complain(mesh.error().message);  // "bunny.ply: line 17: 'x' is no number"
//
// Our own readers because OpenMesh's silently yields nothing on triangle strips, keeps
// coordinates as floats and says of a broken file neither where nor why.
//
// | format | what is read |
// |---|---|
// | PLY | ASCII, binary of either byte order; any scalar types; `vertex`, `face` (polygons), |
// |     | `tristrips` (-1 restarts); other properties and elements are skipped |
// | OBJ | v, f with v, v/vt, v//vn, v/vt/vn; negative indices; continued lines; the rest is skipped
// | | STL | ASCII and binary; corners at exactly equal coordinates become one vertex | | OFF |
// ASCII, with the prefixes ST, C, N; comments; columns behind the coordinates are skipped |
//
// Polygons become fans around their first corner. Faces of one or two corners are skipped.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "shared/mesh/indexed_mesh.h"
#include "shared/result.h"

namespace meshfront {

enum class MeshFormat { ply, obj, stl, off };

// The format by the extension (any case), or by the content where the extension says nothing.
// Untrusted: a broken, truncated or empty file, a coordinate that is not finite and an index out of
// range are Errors that name the file and the line or byte; ErrorCode::notFound if there is no such
// file, unavailable if it cannot be read. Reads the file once, whole; memory is bounded by a small
// multiple of its size. The mesh has at least one triangle and at most 2^31 - 1 vertices.
[[nodiscard]] Result<IndexedMesh> readMesh(const std::filesystem::path& path);

// The same from memory; Errors name the place only.
[[nodiscard]] Result<IndexedMesh> parseMesh(std::string_view content, MeshFormat format);

// What a PLY file shall say of the vertices beside their positions: each empty or one a position.
struct PlyVertexAttributes {
  std::span<const Colour> colours;                // written as uchar red, green, blue, alpha
  std::span<const std::array<float, 3>> normals;  // written as float nx, ny, nz
};

// Binary little-endian PLY with double coordinates. Atomic: `path` keeps its old content or gets
// the new one whole (temporary file beside it, fsync, rename). An index out of range is an Error.
[[nodiscard]] Result<void> writePly(const std::filesystem::path& path,
                                    std::span<const std::array<double, 3>> positions,
                                    std::span<const Triangle> triangles,
                                    const PlyVertexAttributes& attributes = {});

}  // namespace meshfront
