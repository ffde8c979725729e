// Normals named corner by corner (OBJ), made one a vertex where that loses nothing.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "shared/mesh/indexed_mesh.h"

namespace meshfront {

// Indices may come before what they point at, so all is settled at the end.
class CornerNormals {
 public:
  void addNormal(const std::array<float, 3>& normal) { normals_.push_back(normal); }
  [[nodiscard]] size_t normalCount() const { return normals_.size(); }
  // A corner at `vertex` names `normal`; both from 0. `vertexCount`: those that are there so far;
  // an index ahead of them may be nonsense, so that no memory is made to fit it.
  void addCorner(uint32_t vertex, uint32_t normal, size_t vertexCount) {
    if (vertex >= vertexCount)
      ahead_.emplace_back(vertex, normal);
    else
      name(vertex, normal);
  }
  // Fills mesh.normals: a vertex all of whose corners name equal normals gets that one, any other
  // 0. If no vertex gets one, they stay empty. Says in mesh.notCarried how many vertices have
  // several. Requires: every vertex < mesh.positions.size(), every normal < normalCount().
  void giveTo(IndexedMesh& mesh);

 private:
  static constexpr uint32_t kNone = UINT32_MAX;
  void name(uint32_t vertex, uint32_t normal) {
    if (vertex >= firstNamed_.size()) firstNamed_.resize(size_t{vertex} + 1, kNone);
    uint32_t& first = firstNamed_[vertex];
    if (first == kNone)
      first = normal;
    else if (first != normal)
      alsoNamed_.emplace_back(vertex, normal);
  }

  std::vector<std::array<float, 3>> normals_;
  std::vector<uint32_t> firstNamed_;                      // by vertex: of its first corner
  std::vector<std::pair<uint32_t, uint32_t>> alsoNamed_;  // vertex, another normal
  std::vector<std::pair<uint32_t, uint32_t>> ahead_;      // vertex that came later, normal
};

}  // namespace meshfront
