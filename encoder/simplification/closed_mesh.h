// The connectivity that is being simplified: OpenMesh's half-edges, filled in bulk and collapsed in
// time that depends on the removed vertex's valence alone. OpenMesh's own add_face and collapse
// also visit the rings of the other corners, and a virtual vertex has as many neighbours as its
// boundary. Faces are left out: nothing here asks for them.
#pragma once

#include <OpenMesh/Core/Mesh/TriConnectivity.hh>
#include <cstdint>
#include <span>

#include "shared/mesh/indexed_mesh.h"

namespace meshfront {

using HalfEdge = OpenMesh::HalfedgeHandle;

class ClosedMesh {
 public:
  // False, and a mesh not to be used, unless every edge lies in exactly two triangles of opposite
  // direction and every vertex has at most one fan. `newIndex` renames the triangles' vertices.
  bool build(uint32_t vertexCount, std::span<const Triangle> triangles,
             std::span<const uint32_t> newIndex);

  [[nodiscard]] HalfEdge outgoing(uint32_t vertex) const {
    return kernel_.halfedge_handle(OpenMesh::VertexHandle(static_cast<int>(vertex)));
  }
  // Whether the vertex has any triangle.
  [[nodiscard]] bool isUsed(uint32_t vertex) const { return outgoing(vertex).is_valid(); }
  [[nodiscard]] uint32_t target(HalfEdge h) const {
    return static_cast<uint32_t>(kernel_.to_vertex_handle(h).idx());
  }
  [[nodiscard]] HalfEdge opposite(HalfEdge h) const { return kernel_.opposite_halfedge_handle(h); }
  // The next outgoing half-edge clockwise around the origin; it shares a face with h.
  [[nodiscard]] HalfEdge turned(HalfEdge h) const { return kernel_.cw_rotated_halfedge_handle(h); }

  // The corner opposite of the edge that faces h's origin in the triangle right of h: for (o, a, b)
  // with h = oa, the far corner of the other triangle at ab.
  [[nodiscard]] uint32_t across(HalfEdge h) const {
    const HalfEdge facing = kernel_.prev_halfedge_handle(kernel_.opposite_halfedge_handle(h));
    return target(kernel_.next_halfedge_handle(kernel_.opposite_halfedge_handle(facing)));
  }
  // Calls visit(corner) for the third corners of both triangles at the edge.
  template <typename Visit>
  void forOppositeCorners(HalfEdge h, const Visit& visit) const {
    visit(target(kernel_.next_halfedge_handle(h)));
    visit(target(kernel_.next_halfedge_handle(kernel_.opposite_halfedge_handle(h))));
  }

  // Moves the origin of h onto its target. Only under the link condition.
  void collapse(HalfEdge h);

 private:
  // `stays` takes the place of `goes` in the face of the latter.
  void replace(HalfEdge goes, HalfEdge stays);

  OpenMesh::TriConnectivity kernel_;
};

}  // namespace meshfront
