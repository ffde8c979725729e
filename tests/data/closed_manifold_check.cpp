#include "tests/data/closed_manifold_check.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace meshfront {
namespace {

std::string nameOf(const Triangle& t) {
  std::string name;
  for (const uint32_t corner : t)
    name.append(name.empty() ? "(" : ", ").append(std::to_string(corner));
  return name.append(")");
}

}  // namespace

std::string whyNotClosedManifold(size_t vertexCount, std::span<const Triangle> triangles) {
  std::set<Triangle> sets;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t>
      third;  // directed edge: its face's other corner
  std::vector<uint32_t> facesAt(vertexCount);
  std::vector<uint32_t> someNeighbour(vertexCount);
  for (const Triangle& t : triangles) {
    Triangle sorted = t;
    std::sort(sorted.begin(), sorted.end());
    if (sorted[2] >= vertexCount) return "index out of range in " + nameOf(t);
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2]) return "degenerate " + nameOf(t);
    if (!sets.insert(sorted).second) return "a second face on the corners of " + nameOf(t);
    for (size_t i = 0; i < 3; ++i) {
      if (!third.try_emplace({t[i], t[(i + 1) % 3]}, t[(i + 2) % 3]).second)
        return "a directed edge occurs again in " + nameOf(t);
      ++facesAt[t[i]];
      someNeighbour[t[i]] = t[(i + 1) % 3];
    }
  }
  for (const auto& [edge, corner] : third)
    if (!third.contains({edge.second, edge.first}))
      return "no reverse of edge " + std::to_string(edge.first) + " -> " +
             std::to_string(edge.second);
  for (uint32_t vertex = 0; vertex < vertexCount; ++vertex) {
    if (facesAt[vertex] == 0) return "unused vertex " + std::to_string(vertex);
    uint32_t fan = 0;
    uint32_t neighbour = someNeighbour[vertex];
    do {
      neighbour = third.at({vertex, neighbour});
      ++fan;
    } while (neighbour != someNeighbour[vertex]);
    if (fan != facesAt[vertex]) return "several fans at vertex " + std::to_string(vertex);
  }
  return {};
}

}  // namespace meshfront
