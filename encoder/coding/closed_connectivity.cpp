#include "encoder/coding/closed_connectivity.h"

#include <algorithm>

namespace meshfront {
std::vector<uint32_t> twinsOf(std::span<const Triangle> triangles, uint32_t vertexCount) {
  // Bucket the half-edges by their smaller end, then match within each bucket.
  std::vector<uint32_t> begin(size_t{vertexCount} + 1, 0);
  const auto ends = [&](uint32_t h) {
    const Triangle& t = triangles[h / 3];
    return std::pair{t[h % 3], t[(h + 1) % 3]};
  };
  const auto count = static_cast<uint32_t>(triangles.size() * 3);
  for (uint32_t h = 0; h < count; ++h) {
    const auto [from, to] = ends(h);
    ++begin[std::min(from, to) + 1];
  }
  for (uint32_t v = 0; v < vertexCount; ++v) begin[v + 1] += begin[v];
  std::vector<uint32_t> bucket(count);
  {
    std::vector<uint32_t> next(begin.begin(), begin.end() - 1);
    for (uint32_t h = 0; h < count; ++h) {
      const auto [from, to] = ends(h);
      bucket[next[std::min(from, to)]++] = h;
    }
  }
  std::vector<uint32_t> twin(count);
  std::vector<uint32_t> partner(vertexCount, UINT32_MAX);  // by larger end: a half-edge not matched
  for (uint32_t v = 0; v < vertexCount; ++v) {
    for (uint32_t i = begin[v]; i < begin[v + 1]; ++i) {
      const uint32_t h = bucket[i];
      const auto [from, to] = ends(h);
      uint32_t& other = partner[std::max(from, to)];
      if (other == UINT32_MAX) {
        other = h;
      } else {
        twin[h] = other;
        twin[other] = h;
        other = UINT32_MAX;
      }
    }
  }
  return twin;
}

FaceOrigins faceOrigins(std::span<const Triangle> triangles, const VertexForest& forest) {
  FaceOrigins out;
  out.creator.assign(triangles.size(), kNoNode);
  out.leftFace.assign(forest.splitCount(), UINT32_MAX);
  out.rightFace.assign(forest.splitCount(), UINT32_MAX);
  for (uint32_t f = 0; f < triangles.size(); ++f) {
    const Triangle& t = triangles[f];
    int deepest = -1;
    size_t side = 0;  // the pair (side, side + 1) of corners has that ancestor
    for (size_t i = 0; i < 3; ++i) {
      const int depth =
          static_cast<int>(partingDepth(forest.id(t[i]), forest.id(t[(i + 1) % 3]))) - 1;
      if (depth > deepest) {
        deepest = depth;
        side = i;
      }
    }
    if (deepest < 0) {
      out.baseFaces.push_back(f);
      continue;
    }
    ForestNode node = t[side];
    for (int depth = forest.id(node).depth; depth > deepest; --depth) node = forest.parent(node);
    out.creator[f] = node;
    // (u, t, l) if the first of the pair is under u, else (t, u, r), which is f_r.
    const bool firstIsRight = forest.id(t[side]).step(static_cast<unsigned>(deepest));
    auto& faces = firstIsRight ? out.rightFace : out.leftFace;
    faces[node - forest.leafCount()] = f;
  }
  return out;
}

}  // namespace meshfront
