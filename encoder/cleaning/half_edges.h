// Half-edge h = 3 * face + i runs from corner i of the face to the next one.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/mesh/indexed_mesh.h"

namespace meshfront {

using HalfEdge = uint32_t;
inline constexpr HalfEdge kNoTwin = UINT32_MAX;

inline HalfEdge nextInFace(HalfEdge h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}
inline HalfEdge previousInFace(HalfEdge h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}
inline uint32_t originOf(const std::vector<Triangle>& triangles, HalfEdge h) {
  return triangles[h / 3][h % 3];
}
inline uint32_t targetOf(const std::vector<Triangle>& triangles, HalfEdge h) {
  return originOf(triangles, nextInFace(h));
}

}  // namespace meshfront
