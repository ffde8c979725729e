// Triangles with twins: the connectivity of a closed mesh that is split and collapsed at vertices.
//
// Rings may hold a vertex more than once and two vertices may share several edges while a mesh is
// refined selectively, so neighbours are named by half-edge, never looked up by vertex. Half-edge
// halfEdge(f, i) runs from corner i of face f to corner (i + 1) % 3. The faces of a split are a
// pair, which lies in one cache line with the name of the node that was split; pairs lie behind the
// base's faces and are numbered as the vertices that came with them. Invariants, whatever the
// sequence of calls: twin is an involution between half-edges of opposite ends; the three corners
// of a face are different; every vertex in use has at least one face.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/hierarchy/node_id.h"
#include "shared/mesh/indexed_mesh.h"
#include "shared/refinement/growing_array.h"

namespace meshfront {

using HalfEdge = uint32_t;  // 4 face + corner
using FaceSlot = uint32_t;

class HalfEdgeMesh {
 public:
  HalfEdgeMesh() = default;
  // `triangles`: closed and oriented, every vertex used; fewer than 2^29.
  HalfEdgeMesh(std::span<const Triangle> triangles, uint32_t vertexCount);

  [[nodiscard]] static HalfEdge halfEdge(FaceSlot face, uint32_t corner) {
    return 4 * face + corner;
  }
  [[nodiscard]] static FaceSlot faceOf(HalfEdge h) { return h >> 2; }
  [[nodiscard]] static HalfEdge next(HalfEdge h) { return (h & 3) == 2 ? h - 2 : h + 1; }
  [[nodiscard]] static HalfEdge previous(HalfEdge h) { return (h & 3) == 0 ? h + 2 : h - 1; }

  [[nodiscard]] uint32_t baseFaces() const { return baseFaces_; }
  // A base with an odd number of faces is followed by one that is not used.
  [[nodiscard]] uint32_t faceSlots() const { return static_cast<uint32_t>(2 * pairs_.size()); }
  [[nodiscard]] uint32_t vertexSlots() const { return static_cast<uint32_t>(outgoing_.size()); }
  // The pair of faces that came with a vertex behind the base's.
  [[nodiscard]] FaceSlot facesOf(uint32_t vertex) const {
    return 2 * (vertex - baseVertices_ + basePairs_);
  }
  [[nodiscard]] uint32_t origin(HalfEdge h) const { return pairs_[h >> 3].corner[h & 7]; }
  [[nodiscard]] uint32_t destination(HalfEdge h) const { return origin(next(h)); }
  [[nodiscard]] HalfEdge twin(HalfEdge h) const { return pairs_[h >> 3].twin[h & 7]; }
  // Who was split for the face; of a face behind the base's.
  [[nodiscard]] NodeId creator(FaceSlot face) const {
    const FacePair& pair = pairs_[face >> 1];
    return {pair.twin[3], static_cast<uint8_t>(pair.twin[7]),
            uint64_t{pair.corner[3]} << 32 | pair.corner[7]};
  }

  [[nodiscard]] HalfEdge outgoing(uint32_t vertex) const { return outgoing_[vertex]; }
  void prefetchOutgoing(uint32_t vertex) const { __builtin_prefetch(&outgoing_[vertex]); }
  void prefetchFace(HalfEdge h) const { __builtin_prefetch(&pairs_[h >> 3]); }
  // The outgoing half-edges of a vertex, counter-clockwise. Face i of the ring (that of ring[i])
  // lies between ring[i] and ring[i + 1].
  void ring(uint32_t vertex, std::vector<HalfEdge>& out) const;
  // The same, one by one: visit(half-edge).
  template <typename Visit>
  void forEachOutgoing(uint32_t vertex, const Visit& visit) const {
    const HalfEdge first = outgoing_[vertex];
    HalfEdge h = first;
    do {
      visit(h);
      h = twin(previous(h));
    } while (h != first);
  }

  // Splits `vertex` into itself (u) and a new vertex t. `ring` is ring(vertex); the faces from
  // entry `left` counter-clockwise to entry `right` stay at u, the others go to t. Where left ==
  // right: all go to t if `leftFirst`, else all stay. Adds f_l = (u, t, l) and f_r = (u, r, t) in a
  // pair, created by `creator`.
  struct Split {
    uint32_t vertex;     // the slot of t
    FaceSlot firstFace;  // f_l; f_r is the next one
    // The entries whose faces went to t: from `right` on, that many, cyclically.
    uint32_t moved;
  };
  Split split(uint32_t vertex, std::span<const HalfEdge> ring, uint32_t left, uint32_t right,
              bool leftFirst, const NodeId& creator);

  // Undoes the split that `t` came with: takes out its pair of faces and gives its other faces to
  // u.
  void collapse(uint32_t t);

  // Bytes held, and those that would be held with that many more splits in the mesh.
  [[nodiscard]] size_t memoryBytes() const {
    return pairs_.memoryBytes() + outgoing_.memoryBytes();
  }
  [[nodiscard]] size_t memoryBytesAfter(size_t splits) const {
    const size_t more = splits - std::min<size_t>(splits, freeCount_);
    return pairs_.memoryBytesFor(pairs_.size() + more) +
           outgoing_.memoryBytesFor(outgoing_.size() + more);
  }
  [[nodiscard]] uint32_t freeVertices() const { return freeCount_; }

 private:
  static constexpr uint32_t kNoVertex = UINT32_MAX;
  // By half-edge & 7; entries 3 and 7 hold the creator.
  struct alignas(64) FacePair {
    std::array<uint32_t, 8> corner;  // the vertex it starts at
    std::array<HalfEdge, 8> twin;
  };

  [[nodiscard]] uint32_t& corner(HalfEdge h) { return pairs_[h >> 3].corner[h & 7]; }
  void setTwin(HalfEdge h, HalfEdge twin) { pairs_[h >> 3].twin[h & 7] = twin; }
  void glue(HalfEdge a, HalfEdge b) {
    setTwin(a, b);
    setTwin(b, a);
  }

  uint32_t baseFaces_ = 0;
  uint32_t basePairs_ = 0;
  uint32_t baseVertices_ = 0;
  GrowingArray<FacePair> pairs_;
  // By vertex: any half-edge that starts there; of a free one the next free one.
  GrowingArray<HalfEdge> outgoing_;
  uint32_t firstFree_ = kNoVertex;
  uint32_t freeCount_ = 0;
};

}  // namespace meshfront
