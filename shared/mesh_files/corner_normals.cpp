#include "shared/mesh_files/corner_normals.h"

#include <algorithm>
#include <string>

namespace meshfront {

void CornerNormals::giveTo(IndexedMesh& mesh) {
  for (const auto& [vertex, normal] : ahead_) name(vertex, normal);
  ahead_.clear();
  std::vector<bool> several(mesh.positions.size());
  uint64_t severalCount = 0;
  for (const auto& [vertex, normal] : alsoNamed_) {
    if (several[vertex] || normals_[normal] == normals_[firstNamed_[vertex]]) continue;
    several[vertex] = true;
    ++severalCount;
  }
  if (severalCount > 0)
    mesh.notCarried.push_back("normals: " + std::to_string(severalCount) +
                              (severalCount == 1 ? " vertex has" : " vertices have") +
                              " different ones at different corners");
  const auto named = static_cast<uint64_t>(
      std::count_if(firstNamed_.begin(), firstNamed_.end(), [](uint32_t n) { return n != kNone; }));
  if (named == severalCount) return;
  mesh.normals.resize(mesh.positions.size());
  for (size_t vertex = 0; vertex < firstNamed_.size(); ++vertex)
    if (firstNamed_[vertex] != kNone && !several[vertex])
      mesh.normals[vertex] = normals_[firstNamed_[vertex]];
}

}  // namespace meshfront
