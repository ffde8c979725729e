// The triangles of the base mesh, coded by growing each component over its boundary edges.
//
//   number of components (Exp-Golomb 1); for each: its first triangle (a, b, c), where a is the
//   smallest vertex not seen so far and b, c take truncated binary codes; then, for each edge x ->
//   y that still lacks its neighbour, in the order it appeared, the third corner z of (y, x, z):
//     0    a vertex not seen before, truncated binary over all vertices
//     10   the end of the newest open edge that starts at y
//     110  the start of the newest open edge that ends at x
//     111  any vertex, truncated binary over all vertices
// The first rule that fits is used. Triangles are numbered in the order in which they are coded.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/bits/bit_reader.h"
#include "shared/bits/bit_writer.h"
#include "shared/mesh/indexed_mesh.h"
#include "shared/result.h"

namespace meshfront {

// `triangles`: a closed, oriented 2-manifold without repeated edges that uses all vertices.
void writeBaseConnectivity(BitWriter& out, std::span<const Triangle> triangles,
                           uint32_t vertexCount);

// Untrusted. The result is closed and oriented: every edge is in exactly two triangles, once in
// each direction; all vertices are used.
[[nodiscard]] Result<std::vector<Triangle>> readBaseConnectivity(BitReader& in,
                                                                 uint32_t vertexCount);

}  // namespace meshfront
