#include "encoder/simplification/end_state.h"

#include <algorithm>
#include <utility>

#include "shared/hierarchy/node_id.h"

namespace meshfront {

namespace {

constexpr uint32_t kSmallestComponent = 4;  // vertices: a tetrahedron

class EndStateSweep {
 public:
  EndStateSweep(const CollapsibleMesh& mesh, const std::vector<SimplifyVertex>& vertices,
                uint32_t realCount, uint32_t maxValence)
      : mesh_(mesh),
        vertices_(vertices),
        realCount_(realCount),
        maxValence_(maxValence),
        marked_(vertices.size()) {}

  EndState run() {
    countComponents();
    for (uint32_t v = 0; v < vertices_.size(); ++v) {
      if (isLeft(v)) lookAround(v);
    }
    return out_;
  }

 private:
  [[nodiscard]] bool isLeft(uint32_t v) const {
    return vertices_[v].state != SimplifyVertex::State::removed && mesh_.outgoing(v).is_valid();
  }
  [[nodiscard]] bool isVirtual(uint32_t v) const { return v >= realCount_; }

  template <typename Visit>
  void forRing(uint32_t v, const Visit& visit) const {
    const HalfEdge first = mesh_.outgoing(v);
    HalfEdge h = first;
    do {
      visit(mesh_.target(h));
      h = mesh_.turned(h);
    } while (h != first);
  }

  // Connected parts, those that are down to a tetrahedron, and, by Euler's formula, handles.
  void countComponents() {
    std::vector<bool> seen(vertices_.size());
    std::vector<uint32_t> waiting;
    uint64_t count = 0;
    uint64_t halfEdges = 0;
    for (uint32_t start = 0; start < vertices_.size(); ++start) {
      if (seen[start] || !isLeft(start)) continue;
      uint32_t size = 0;
      seen[start] = true;
      waiting.push_back(start);
      while (!waiting.empty()) {
        const uint32_t v = waiting.back();
        waiting.pop_back();
        ++size;
        halfEdges += vertices_[v].valence;
        forRing(v, [&](uint32_t w) {
          if (seen[w]) return;
          seen[w] = true;
          waiting.push_back(w);
        });
      }
      count += size;
      ++out_.components;
      out_.smallestComponents += static_cast<uint64_t>(size == kSmallestComponent);
    }
    // vertices - edges + faces = 2 components - 2 handles, and faces are half-edges / 3.
    const int64_t euler = static_cast<int64_t>(count) - static_cast<int64_t>(halfEdges / 6);
    out_.handles = out_.components - static_cast<uint64_t>(euler / 2);
  }

  // Each edge is looked at from the end with more neighbours, so that the shorter ring is walked.
  void lookAround(uint32_t v) {
    forRing(v, [&](uint32_t w) { marked_[w] = true; });
    const auto rank = [&](uint32_t at) { return std::pair(vertices_[at].valence, at); };
    forRing(v, [&](uint32_t w) {
      if (isVirtual(v) || isVirtual(w)) {
        if (!isVirtual(v)) onto(v, w);
      } else if (rank(w) < rank(v)) {
        lookAt(v, w);
      }
    });
    forRing(v, [&](uint32_t w) { marked_[w] = false; });
  }

  void onto(uint32_t v, uint32_t virtualVertex) {
    ++out_.directions;
    // A triangle with its virtual vertex: all three corners have no other neighbours.
    const bool smallest = vertices_[v].valence == 3 && vertices_[virtualVertex].valence == 3;
    ++(smallest ? out_.smallestComponent : out_.virtualVertex);
  }

  void lookAt(uint32_t v, uint32_t w) {
    const SimplifyVertex& a = vertices_[v];
    const SimplifyVertex& b = vertices_[w];
    out_.directions += 2;
    if (a.valence == 3 && b.valence == 3) {
      out_.smallestComponent += 2;
      return;
    }
    uint32_t common = 0;
    forRing(w, [&](uint32_t u) { common += static_cast<uint32_t>(marked_[u]); });
    const bool link = common != 2;
    const bool depth = std::max(a.height, b.height) >= kMaxDepth;
    for (const SimplifyVertex* removed : {&a, &b}) {
      const bool valence = removed->valence > maxValence_;
      out_.link += static_cast<uint64_t>(link);
      out_.depth += static_cast<uint64_t>(depth);
      out_.valence += static_cast<uint64_t>(valence);
      if (link) continue;
      if (depth && !valence) ++out_.depthAlone;
      if (!depth && valence) {
        ++out_.valenceAlone;
        out_.valenceNeeded = out_.valenceNeeded == 0
                                 ? removed->valence
                                 : std::min(out_.valenceNeeded, removed->valence);
      }
    }
  }

  const CollapsibleMesh& mesh_;
  const std::vector<SimplifyVertex>& vertices_;
  uint32_t realCount_;
  uint32_t maxValence_;
  std::vector<bool> marked_;  // the ring being looked at
  EndState out_;
};

}  // namespace

EndState sweepEndState(const CollapsibleMesh& mesh, const std::vector<SimplifyVertex>& vertices,
                       uint32_t realCount, uint32_t maxValence) {
  return EndStateSweep(mesh, vertices, realCount, maxValence).run();
}

}  // namespace meshfront
