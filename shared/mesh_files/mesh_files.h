// Reads triangle meshes from PLY, OBJ, STL, OFF and glTF files, compressed or not, and writes PLY.
//
//   auto mesh = readMesh("bunny.ply.xz");
//   if (!mesh) return complain(mesh.error().message);  // "bunny.ply: line 17: 'x' is no number"
//
// Our own readers because OpenMesh's silently yields nothing on triangle strips, keeps
// coordinates as floats and says of a broken file neither where nor why.
//
// PLY   ASCII, binary of either byte order; any scalar types; `vertex` (x y z, nx ny nz, red green
//       blue alpha), `face` (polygons), `tristrips` (-1 restarts).
// OBJ   v (with colours behind the coordinates), vn, f with v, v/vt, v//vn, v/vt/vn; negative
//       indices; continued lines. A vertex has a normal if all its corners name the same.
// STL   ASCII and binary; corners at exactly equal coordinates become one vertex.
// OFF   ASCII and binary, with the prefixes ST, C, N; comments.
// glTF  2.0, .gltf and .glb; buffers in data URIs, the file itself and files in its folder; all
//       meshes of the default scene (or all scenes) in world coordinates; triangles, strips, fans,
//       indexed or not; sparse and normalized accessors; NORMAL, COLOR_0. Not compressed by an
//       extension.
//
// What of a file's mesh is not carried, IndexedMesh::notCarried says. Channels of colours become 8
// bits: those of 0 .. 1 if they are real numbers (in OBJ and OFF: unless all of the file are whole
// and one is larger than 1), of 0 .. 255 or 0 .. 65535 if whole; as stored, no colour space is
// converted. Of vertices without a colour or normal among others that have one,
// the colour is opaque white and the normal 0.
//
// Polygons become fans around their first corner. Faces of one or two corners are skipped.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

#include "shared/mesh/indexed_mesh.h"
#include "shared/result.h"

namespace meshfront {

enum class MeshFormat { ply, obj, stl, off, gltf };

// The format by the extension (any case, without .gz, .xz or .zst), or by the content where the
// extension says nothing. What starts as gzip, xz or Zstandard is decompressed, whatever its name.
// Untrusted: a broken, truncated or empty file, a coordinate that is not finite and an index out of
// range are Errors that name the file and the line, byte or element; ErrorCode::notFound if there
// is no such file, unavailable if it cannot be read. Reads the file once, whole; memory is bounded
// by a small multiple of its size, decompressed: that must fit into the memory available and into
// 64 GiB, and so must a glTF scene with all instances of its meshes (tooLarge). The mesh has at
// least one triangle and at most 2^31 - 1 vertices.
[[nodiscard]] Result<IndexedMesh> readMesh(const std::filesystem::path& path);

// The same from memory, uncompressed; Errors name the place only. A glTF document takes buffers in
// other files from `folder`.
[[nodiscard]] Result<IndexedMesh> parseMesh(
    std::string_view content, MeshFormat format,
    const std::optional<std::filesystem::path>& folder = std::nullopt);

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
