#include "shared/refinement/half_edge_mesh.h"

#include <algorithm>

namespace meshfront {

HalfEdgeMesh::HalfEdgeMesh(std::span<const Triangle> triangles, uint32_t vertexCount)
    : baseFaces_(static_cast<uint32_t>(triangles.size())),
      twin_(triangles.size() * 3),
      outgoing_(vertexCount, 0) {
  corner_.reserve(triangles.size() * 3);
  for (const Triangle& t : triangles) corner_.insert(corner_.end(), t.begin(), t.end());
  struct Directed {
    uint64_t ends;  // smaller and larger vertex
    HalfEdge halfEdge;
  };
  std::vector<Directed> edges;
  edges.reserve(corner_.size());
  for (HalfEdge h = 0; h < corner_.size(); ++h) {
    outgoing_[corner_[h]] = h;
    const uint64_t low = std::min(origin(h), destination(h));
    edges.push_back({low << 32 | std::max(origin(h), destination(h)), h});
  }
  std::sort(edges.begin(), edges.end(),
            [](const Directed& a, const Directed& b) { return a.ends < b.ends; });
  for (size_t i = 0; i + 1 < edges.size(); i += 2) glue(edges[i].halfEdge, edges[i + 1].halfEdge);
}

void HalfEdgeMesh::ring(uint32_t vertex, std::vector<HalfEdge>& out) const {
  out.clear();
  const HalfEdge first = outgoing_[vertex];
  HalfEdge h = first;
  do {
    out.push_back(h);
    h = twin_[previous(h)];
  } while (h != first);
}

HalfEdgeMesh::Split HalfEdgeMesh::split(uint32_t vertex, std::span<const HalfEdge> ring,
                                        uint32_t left, uint32_t right, bool leftFirst) {
  Split out{};
  if (freeVertices_.empty()) {
    out.vertex = static_cast<uint32_t>(outgoing_.size());
    outgoing_.push_back(0);
  } else {
    out.vertex = freeVertices_.back();
    freeVertices_.pop_back();
  }
  if (freePairs_.empty()) {
    out.firstFace = faceSlots();
    corner_.resize(corner_.size() + 6);
    twin_.resize(twin_.size() + 6);
  } else {
    out.firstFace = freePairs_.back();
    freePairs_.pop_back();
  }
  const auto size = static_cast<uint32_t>(ring.size());
  const uint32_t u = vertex;
  const uint32_t t = out.vertex;
  const uint32_t l = destination(ring[left]);
  const uint32_t r = destination(ring[right]);

  // t's faces run counter-clockwise from entry `right` to entry `left`.
  uint32_t moved = right <= left ? left - right : left + size - right;
  if (left == right) moved = leftFirst ? size : 0;
  for (uint32_t i = 0; i < moved; ++i)
    corner_[ring[right + i < size ? right + i : right + i - size]] = t;

  const HalfEdge ut = 3 * out.firstFace;  // f_l: u -> t -> l
  const HalfEdge tl = ut + 1;
  const HalfEdge lu = ut + 2;
  const HalfEdge ur = ut + 3;  // f_r: u -> r -> t
  const HalfEdge rt = ut + 4;
  const HalfEdge tu = ut + 5;
  corner_[ut] = corner_[ur] = u;
  corner_[tl] = corner_[tu] = t;
  corner_[lu] = l;
  corner_[rt] = r;
  glue(ut, tu);
  const HalfEdge leftOut = ring[left];
  const HalfEdge rightOut = ring[right];
  if (left != right) {
    const HalfEdge leftIn = twin_[leftOut];
    const HalfEdge rightIn = twin_[rightOut];
    glue(lu, leftOut);   // u -> l, in a face of u
    glue(tl, leftIn);    // l -> t
    glue(rt, rightOut);  // t -> r, in a face of t
    glue(ur, rightIn);   // r -> u
  } else {
    const HalfEdge in = twin_[leftOut];
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

void HalfEdgeMesh::collapse(FaceSlot firstFace) {
  const HalfEdge ut = 3 * firstFace;
  const HalfEdge tl = ut + 1;
  const HalfEdge lu = ut + 2;
  const HalfEdge ur = ut + 3;
  const HalfEdge rt = ut + 4;
  const HalfEdge tu = ut + 5;
  const uint32_t u = corner_[ut];
  const uint32_t t = corner_[tl];
  const uint32_t l = corner_[lu];
  const uint32_t r = corner_[rt];
  // t's faces, from behind f_r round to f_l.
  for (HalfEdge h = twin_[previous(tu)]; h != tu; h = twin_[previous(h)]) corner_[h] = u;
  // Vertices must not keep a half-edge that goes. Where u or t stands alone between f_l and f_r,
  // the pair's outer edges on that side are glued to each other, and the other side has faces.
  const auto goes = [&](HalfEdge h) { return h / 3 == firstFace || h / 3 == firstFace + 1; };
  const auto stays = [&](HalfEdge one, HalfEdge other) { return goes(one) ? other : one; };
  if (goes(outgoing_[l])) outgoing_[l] = stays(twin_[tl], twin_[ur]);
  if (goes(outgoing_[r])) outgoing_[r] = stays(twin_[ur], twin_[tl]);
  outgoing_[u] = stays(twin_[lu], twin_[rt]);
  // One after the other, so that the second gluing sees an edge that the first glued to its face.
  glue(twin_[lu], twin_[tl]);
  glue(twin_[ur], twin_[rt]);
  freePairs_.push_back(firstFace);
  freeVertices_.push_back(t);
}

}  // namespace meshfront
