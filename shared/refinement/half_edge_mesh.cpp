#include "shared/refinement/half_edge_mesh.h"

#include <algorithm>

namespace meshfront {

HalfEdgeMesh::HalfEdgeMesh(std::span<const Triangle> triangles, uint32_t vertexCount)
    : baseFaces_(static_cast<uint32_t>(triangles.size())),
      basePairs_((baseFaces_ + 1) / 2),
      baseVertices_(vertexCount) {
  pairs_.resize(basePairs_, FacePair{});
  outgoing_.resize(vertexCount, 0);
  struct Directed {
    uint64_t ends;  // smaller and larger vertex
    HalfEdge halfEdge;
  };
  std::vector<Directed> edges;
  edges.reserve(triangles.size() * 3);
  for (FaceSlot face = 0; face < baseFaces_; ++face)
    for (uint32_t i = 0; i < 3; ++i) {
      const HalfEdge h = halfEdge(face, i);
      const uint64_t from = triangles[face][i];
      const uint64_t to = triangles[face][(i + 1) % 3];
      corner(h) = static_cast<uint32_t>(from);
      outgoing_[from] = h;
      edges.push_back({std::min(from, to) << 32 | std::max(from, to), h});
    }
  std::sort(edges.begin(), edges.end(),
            [](const Directed& a, const Directed& b) { return a.ends < b.ends; });
  for (size_t i = 0; i + 1 < edges.size(); i += 2) glue(edges[i].halfEdge, edges[i + 1].halfEdge);
}

void HalfEdgeMesh::ring(uint32_t vertex, std::vector<HalfEdge>& out) const {
  out.clear();
  forEachOutgoing(vertex, [&](HalfEdge h) { out.push_back(h); });
}

HalfEdgeMesh::Split HalfEdgeMesh::split(uint32_t vertex, std::span<const HalfEdge> ring,
                                        uint32_t left, uint32_t right, bool leftFirst,
                                        const NodeId& creator) {
  Split out{};
  if (firstFree_ == kNoVertex) {
    out.vertex = vertexSlots();
    outgoing_.append();
    pairs_.append();
  } else {
    out.vertex = firstFree_;
    firstFree_ = outgoing_[out.vertex];
    --freeCount_;
  }
  out.firstFace = facesOf(out.vertex);
  const auto size = static_cast<uint32_t>(ring.size());
  const uint32_t u = vertex;
  const uint32_t t = out.vertex;
  const uint32_t l = destination(ring[left]);
  const uint32_t r = destination(ring[right]);

  // t's faces run counter-clockwise from entry `right` to entry `left`.
  out.moved = right <= left ? left - right : left + size - right;
  if (left == right) out.moved = leftFirst ? size : 0;
  for (uint32_t i = 0; i < out.moved; ++i)
    corner(ring[right + i < size ? right + i : right + i - size]) = t;

  const HalfEdge ut = halfEdge(out.firstFace, 0);  // f_l: u -> t -> l
  const HalfEdge tl = ut + 1;
  const HalfEdge lu = ut + 2;
  const HalfEdge ur = ut + 4;  // f_r: u -> r -> t
  const HalfEdge rt = ut + 5;
  const HalfEdge tu = ut + 6;
  FacePair& pair = pairs_[out.firstFace / 2];
  pair.corner = {u, t, l, static_cast<uint32_t>(creator.path >> 32),
                 u, r, t, static_cast<uint32_t>(creator.path)};
  pair.twin[3] = creator.tree;
  pair.twin[7] = creator.depth;
  glue(ut, tu);
  const HalfEdge leftOut = ring[left];
  const HalfEdge rightOut = ring[right];
  if (left != right) {
    const HalfEdge leftIn = twin(leftOut);
    const HalfEdge rightIn = twin(rightOut);
    glue(lu, leftOut);   // u -> l, in a face of u
    glue(tl, leftIn);    // l -> t
    glue(rt, rightOut);  // t -> r, in a face of t
    glue(ur, rightIn);   // r -> u
  } else {
    const HalfEdge in = twin(leftOut);
    if (leftFirst) {  // all faces at t: u stands alone between f_l and f_r
      glue(tl, in);
      glue(rt, leftOut);
      glue(lu, ur);
    } else {
      glue(lu, leftOut);
      glue(ur, in);
      glue(tl, rt);
    }
  }
  outgoing_[u] = ut;
  outgoing_[t] = tu;
  return out;
}

void HalfEdgeMesh::collapse(uint32_t t) {
  const FaceSlot firstFace = facesOf(t);
  const HalfEdge ut = halfEdge(firstFace, 0);
  const HalfEdge tl = ut + 1;
  const HalfEdge lu = ut + 2;
  const HalfEdge ur = ut + 4;
  const HalfEdge rt = ut + 5;
  const HalfEdge tu = ut + 6;
  const uint32_t u = origin(ut);
  const uint32_t l = origin(lu);
  const uint32_t r = origin(rt);
  // t's faces, from behind f_r round to f_l.
  for (HalfEdge h = twin(previous(tu)); h != tu; h = twin(previous(h))) corner(h) = u;
  // Vertices must not keep a half-edge that goes. Where u or t stands alone between f_l and f_r,
  // the pair's outer edges on that side are glued to each other, and the other side has faces.
  const auto goes = [&](HalfEdge h) { return faceOf(h) / 2 == firstFace / 2; };
  const auto stays = [&](HalfEdge one, HalfEdge other) { return goes(one) ? other : one; };
  if (goes(outgoing_[l])) outgoing_[l] = stays(twin(tl), twin(ur));
  if (goes(outgoing_[r])) outgoing_[r] = stays(twin(ur), twin(tl));
  outgoing_[u] = stays(twin(lu), twin(rt));
  // One after the other, so that the second gluing sees an edge that the first glued to its face.
  glue(twin(lu), twin(tl));
  glue(twin(ur), twin(rt));
  outgoing_[t] = firstFree_;
  firstFree_ = t;
  ++freeCount_;
}

}  // namespace meshfront
