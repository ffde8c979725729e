// Triangles with twins: the connectivity of a closed mesh that is split and collapsed at vertices.
//
// Rings may hold a vertex more than once and two vertices may share several edges while a mesh is
// refined selectively, so neighbours are named by half-edge, never looked up by vertex. Half-edge
// 3 f + i runs from corner i of face f to corner (i + 1) % 3. Faces come in pairs behind the
// base's. Invariants, whatever the sequence of calls: twin is an involution between half-edges of
// opposite ends; the three corners of a face are different; every vertex in use has at least one
// face.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/mesh/indexed_mesh.h"

namespace meshfront {

using HalfEdge = uint32_t;
using FaceSlot = uint32_t;

class HalfEdgeMesh {
 public:
  HalfEdgeMesh() = default;
  // `triangles`: closed and oriented, every vertex used.
  HalfEdgeMesh(std::span<const Triangle> triangles, uint32_t vertexCount);

  [[nodiscard]] uint32_t baseFaces() const { return baseFaces_; }
  [[nodiscard]] uint32_t faceSlots() const { return static_cast<uint32_t>(twin_.size() / 3); }
  [[nodiscard]] uint32_t origin(HalfEdge h) const { return corner_[h]; }
  [[nodiscard]] uint32_t destination(HalfEdge h) const { return corner_[next(h)]; }
  [[nodiscard]] HalfEdge twin(HalfEdge h) const { return twin_[h]; }
  [[nodiscard]] static HalfEdge next(HalfEdge h) { return h % 3 == 2 ? h - 2 : h + 1; }
  [[nodiscard]] static HalfEdge previous(HalfEdge h) { return h % 3 == 0 ? h + 2 : h - 1; }
  [[nodiscard]] uint32_t vertexSlots() const { return static_cast<uint32_t>(outgoing_.size()); }

  // The outgoing half-edges of a vertex, counter-clockwise. Face i of the ring (that of ring[i])
  // lies between ring[i] and ring[i + 1].
  void ring(uint32_t vertex, std::vector<HalfEdge>& out) const;

  // Splits `vertex` into itself (u) and a new vertex t. `ring` is ring(vertex); the faces from
  // entry `left` counter-clockwise to entry `right` stay at u, the others go to t. Where left ==
  // right: all go to t if `leftFirst`, else all stay. Adds f_l = (u, t, l) and f_r = (u, r, t) in a
  // pair.
  struct Split {
    uint32_t vertex;     // the slot of t
    FaceSlot firstFace;  // f_l; f_r is the next one
  };
  Split split(uint32_t vertex, std::span<const HalfEdge> ring, uint32_t left, uint32_t right,
              bool leftFirst);

  // Undoes a split: takes out the pair of faces at `firstFace` and gives t's other faces to u.
  void collapse(FaceSlot firstFace);

 private:
  void glue(HalfEdge a, HalfEdge b) {
    twin_[a] = b;
    twin_[b] = a;
  }

  uint32_t baseFaces_ = 0;
  std::vector<uint32_t> corner_;    // by half-edge: the vertex it starts at
  std::vector<HalfEdge> twin_;      // by half-edge
  std::vector<HalfEdge> outgoing_;  // by vertex: any half-edge that starts there
  std::vector<FaceSlot> freePairs_;
  std::vector<uint32_t> freeVertices_;
};

}  // namespace meshfront
