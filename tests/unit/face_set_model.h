// Simplification as one would write it to be sure of it: what the simplifier is held against.
#pragma once

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "encoder/cleaning/close_mesh.h"
#include "encoder/simplification/simplify.h"

namespace meshfront {

struct SimplifyInput {
  std::vector<GridPosition> positions;
  uint32_t virtualCount = 0;
  std::vector<Triangle> triangles;
  size_t realTriangleCount = 0;
};

inline SimplifyInput closedInput(const IndexedMesh& mesh,
                                 unsigned bits = kDefaultQuantizationBits) {
  CleaningReport report;
  const Result<ClosedMesh> result = closeMesh(mesh, report);
  SimplifyInput input;
  if (!result) return input;
  const Quantization grid = quantizationFor(result->positions, bits);
  for (const auto& p : result->positions) input.positions.push_back(grid.toGrid(p));
  input.virtualCount = result->virtualCount;
  input.triangles = result->triangles;
  input.realTriangleCount = result->realTriangleCount;
  return input;
}

// Replays a log on sets of faces: slow, and nothing in common with the simplifier.
class FaceSetModel {
 public:
  explicit FaceSetModel(const SimplifyInput& input)
      : realCount_(input.positions.size()),
        faces_(input.positions.size() + input.virtualCount),
        heights_(faces_.size(), 0) {
    for (const Triangle& t : input.triangles) {
      for (const uint32_t v : t) faces_[v].insert(fromSmallest(t));
    }
  }

  // Empty, or what rule the collapse breaks.
  [[nodiscard]] std::string whyRefused(const Collapse& collapse) const {
    const auto [kept, removed] = collapse;
    if (kept >= realCount_ || removed >= realCount_) return "virtual vertex";
    if (kept == removed || faces_[removed].empty() || faces_[kept].empty()) return "vertex is gone";
    const std::set<uint32_t> a = neighbours(kept);
    const std::set<uint32_t> b = neighbours(removed);
    if (!a.contains(removed)) return "no edge";
    std::set<uint32_t> common;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(),
                          std::inserter(common, common.begin()));
    if (common.size() != 2) return "link condition";
    if (a.size() == 3 && b.size() == 3) return "tetrahedron";
    if (std::max(heights_[kept], heights_[removed]) >= kMaxDepth) return "too deep";
    return {};
  }
  // The same, and does it if allowed.
  std::string apply(const Collapse& collapse) {
    if (std::string why = whyRefused(collapse); !why.empty()) return why;
    const auto [kept, removed] = collapse;
    heights_[kept] = 1 + std::max(heights_[kept], heights_[removed]);
    const std::set<Triangle> moved = faces_[removed];
    for (const Triangle& t : moved) {
      for (const uint32_t v : t) faces_[v].erase(t);
      Triangle renamed = t;
      std::replace(renamed.begin(), renamed.end(), removed, kept);
      if (std::count(renamed.begin(), renamed.end(), kept) > 1) continue;
      for (const uint32_t v : renamed) faces_[v].insert(fromSmallest(renamed));
    }
    return {};
  }

  [[nodiscard]] std::vector<Triangle> triangles() const {
    std::set<Triangle> all;
    for (const auto& faces : faces_) all.insert(faces.begin(), faces.end());
    return {all.begin(), all.end()};
  }
  [[nodiscard]] std::string whyNotManifold() const {
    std::vector<Triangle> triangles = this->triangles();
    std::map<uint32_t, uint32_t> compact;
    for (Triangle& t : triangles) {
      for (uint32_t& v : t) {
        v = compact.try_emplace(v, static_cast<uint32_t>(compact.size())).first->second;
      }
    }
    return whyNotClosedManifold(compact.size(), triangles);
  }
  // Whether some edge between real vertices could still go.
  [[nodiscard]] bool canCollapse() const {
    for (const Triangle& t : triangles()) {
      for (size_t i = 0; i < 3; ++i) {
        if (whyRefused({t[i], t[(i + 1) % 3]}).empty()) return true;
      }
    }
    return false;
  }
  // What sweepEndState() counts, with no limit on valences.
  [[nodiscard]] EndState endState() const {
    EndState out;
    int64_t euler = 0;
    std::vector<bool> seen(faces_.size());
    for (uint32_t start = 0; start < faces_.size(); ++start) {
      if (faces_[start].empty() || seen[start]) continue;
      std::set<uint32_t> part;
      std::vector<uint32_t> waiting{start};
      while (!waiting.empty()) {
        const uint32_t v = waiting.back();
        waiting.pop_back();
        if (!part.insert(v).second) continue;
        seen[v] = true;
        for (const uint32_t w : neighbours(v)) waiting.push_back(w);
      }
      ++out.components;
      if (part.size() == 4) ++out.smallestComponents;
      size_t halfEdges = 0;
      for (const uint32_t v : part) {
        halfEdges += neighbours(v).size();
        if (v >= realCount_) continue;
        for (const uint32_t w : neighbours(v)) {
          ++out.directions;
          const std::string why = whyRefused({w, v});
          if (part.size() == 4) ++out.smallestComponent;
          if (part.size() == 4) continue;
          if (why == "virtual vertex") ++out.virtualVertex;
          if (why == "link condition") ++out.link;
        }
      }
      euler += static_cast<int64_t>(part.size()) - static_cast<int64_t>(halfEdges / 6);
    }
    out.handles = static_cast<uint64_t>((2 * static_cast<int64_t>(out.components) - euler) / 2);
    return out;
  }
  [[nodiscard]] unsigned maxHeight() const {
    return *std::max_element(heights_.begin(), heights_.end());
  }

 private:
  static Triangle fromSmallest(Triangle t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
  }
  [[nodiscard]] std::set<uint32_t> neighbours(uint32_t vertex) const {
    std::set<uint32_t> result;
    for (const Triangle& t : faces_[vertex]) result.insert(t.begin(), t.end());
    result.erase(vertex);
    return result;
  }

  size_t realCount_;
  std::vector<std::set<Triangle>> faces_;  // by corner; each from its smallest corner
  std::vector<unsigned> heights_;
};

}  // namespace meshfront
