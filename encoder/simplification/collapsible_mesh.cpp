#include "encoder/simplification/collapsible_mesh.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace meshfront {

namespace {

// A half-edge filed under the smaller of its ends: the other end and where it is in the input.
struct FiledEdge {
  uint32_t larger;
  uint32_t corner;  // half-edge from corner c to the next of triangle corner / 3
};

OpenMesh::VertexHandle vertexHandle(uint32_t v) {
  return OpenMesh::VertexHandle(static_cast<int>(v));
}

}  // namespace

bool CollapsibleMesh::build(uint32_t vertexCount, std::span<const Triangle> triangles,
                            std::span<const uint32_t> newIndex) {
  const size_t corners = triangles.size() * 3;
  if (corners % 2 != 0 || corners > static_cast<size_t>(std::numeric_limits<int>::max())) {
    return false;
  }
  for (const Triangle& t : triangles) {
    if (std::max({t[0], t[1], t[2]}) >= vertexCount) return false;
  }
  const auto from = [&](size_t c) { return newIndex[triangles[c / 3][c % 3]]; };
  const auto to = [&](size_t c) { return newIndex[triangles[c / 3][(c + 1) % 3]]; };

  std::vector<uint32_t> start(vertexCount + 1, 0);
  for (size_t c = 0; c < corners; ++c) ++start[std::min(from(c), to(c)) + 1];
  for (size_t v = 0; v < vertexCount; ++v) start[v + 1] += start[v];
  std::vector<FiledEdge> filed(corners);
  {
    std::vector<uint32_t> at(start.begin(), start.end() - 1);
    for (size_t c = 0; c < corners; ++c) {
      filed[at[std::min(from(c), to(c))]++] = {std::max(from(c), to(c)), static_cast<uint32_t>(c)};
    }
  }

  // Pairs of half-edges get neighbouring numbers, and the edges of a vertex are stored together.
  kernel_.resize(vertexCount, corners / 2, 0);
  std::vector<int> halfEdgeOf(corners);
  int edges = 0;
  for (uint32_t v = 0; v < vertexCount; ++v) {
    const auto first = filed.begin() + start[v];
    const auto last = filed.begin() + start[v + 1];
    if ((last - first) % 2 != 0) return false;
    std::sort(first, last, [](const FiledEdge& a, const FiledEdge& b) {
      return a.larger != b.larger ? a.larger < b.larger : a.corner < b.corner;
    });
    for (auto edge = first; edge != last; edge += 2) {
      const uint32_t a = edge[0].corner;
      const uint32_t b = edge[1].corner;
      const bool alone = edge + 2 == last || edge[2].larger != edge[0].larger;
      if (!alone || from(a) != to(b) || to(a) != from(b) || from(a) == to(a)) return false;
      for (const uint32_t c : {a, b}) {
        const HalfEdge h((edges << 1) + static_cast<int>(c == b));
        kernel_.set_vertex_handle(h, vertexHandle(to(c)));
        halfEdgeOf[c] = h.idx();
      }
      ++edges;
    }
  }
  for (size_t c = 0; c < corners; ++c) {
    const HalfEdge h(halfEdgeOf[c]);
    kernel_.set_next_halfedge_handle(h, HalfEdge(halfEdgeOf[c % 3 == 2 ? c - 2 : c + 1]));
    kernel_.set_halfedge_handle(vertexHandle(from(c)), h);
  }

  // If each vertex has one fan, the fans hold all half-edges.
  size_t reached = 0;
  for (uint32_t v = 0; v < vertexCount; ++v) {
    const HalfEdge first = outgoing(v);
    if (!first.is_valid()) continue;
    HalfEdge h = first;
    do {
      ++reached;
      h = turned(h);
    } while (h != first);
  }
  return reached == corners;
}

void CollapsibleMesh::replace(HalfEdge goes, HalfEdge stays) {
  kernel_.set_next_halfedge_handle(stays, kernel_.next_halfedge_handle(goes));
  kernel_.set_next_halfedge_handle(kernel_.prev_halfedge_handle(goes), stays);
}

void CollapsibleMesh::collapse(HalfEdge h) {
  const HalfEdge back = kernel_.opposite_halfedge_handle(h);
  const OpenMesh::VertexHandle kept = kernel_.to_vertex_handle(h);
  for (HalfEdge around = turned(h); around != h; around = turned(around)) {
    kernel_.set_vertex_handle(kernel_.opposite_halfedge_handle(around), kept);
  }
  // Each of the two faces at the edge folds onto the kept vertex's side of it.
  const HalfEdge keptLeft = kernel_.next_halfedge_handle(h);
  const HalfEdge leftRemoved = kernel_.prev_halfedge_handle(h);
  const HalfEdge removedRight = kernel_.next_halfedge_handle(back);
  const HalfEdge rightKept = kernel_.prev_halfedge_handle(back);
  replace(kernel_.opposite_halfedge_handle(leftRemoved), keptLeft);
  replace(kernel_.opposite_halfedge_handle(removedRight), rightKept);

  const HalfEdge leftKept = kernel_.opposite_halfedge_handle(keptLeft);
  kernel_.set_halfedge_handle(kept, keptLeft);
  kernel_.set_halfedge_handle(kernel_.to_vertex_handle(keptLeft), leftKept);
  kernel_.set_halfedge_handle(kernel_.from_vertex_handle(rightKept), rightKept);
}

}  // namespace meshfront
