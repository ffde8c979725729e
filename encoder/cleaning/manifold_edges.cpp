#include "encoder/cleaning/manifold_edges.h"

#include <algorithm>

#include "encoder/cleaning/vertex_buckets.h"

namespace meshfront {

std::vector<HalfEdge> joinManifoldEdges(size_t vertexCount, const std::vector<Triangle>& triangles,
                                        CleaningReport& report) {
  const auto halfEdgeCount = static_cast<uint32_t>(triangles.size() * 3);
  std::vector<HalfEdge> twins(halfEdgeCount, kNoTwin);
  const VertexBuckets buckets(vertexCount, halfEdgeCount, [&](HalfEdge h) {
    return std::min(originOf(triangles, h), targetOf(triangles, h));
  });
  std::vector<uint64_t> keys;  // larger end << 32 | half-edge
  for (uint32_t vertex = 0; vertex < buckets.count(); ++vertex) {
    keys.clear();
    for (const HalfEdge h : buckets[vertex])
      keys.push_back(uint64_t{std::max(originOf(triangles, h), targetOf(triangles, h))} << 32 | h);
    std::sort(keys.begin(), keys.end());
    for (size_t first = 0, end = 0; first < keys.size(); first = end) {
      while (end < keys.size() && keys[end] >> 32 == keys[first] >> 32) ++end;
      const auto h = static_cast<HalfEdge>(keys[first]);
      if (end - first > 2) {
        ++report.nonManifoldEdges;
      } else if (end - first == 2) {
        const auto other = static_cast<HalfEdge>(keys[first + 1]);
        if (originOf(triangles, h) == originOf(triangles, other)) {
          ++report.inconsistentEdges;
        } else {
          twins[h] = other;
          twins[other] = h;
        }
      }
    }
  }
  return twins;
}

}  // namespace meshfront
