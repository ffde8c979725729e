#include "shared/mesh/same_triangles.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace meshfront {
namespace {

uint64_t packed(const GridPosition& p) {
  constexpr uint64_t kMask = (1U << 21) - 1;
  return (static_cast<uint64_t>(p[0]) & kMask) << 42 | (static_cast<uint64_t>(p[1]) & kMask) << 21 |
         (static_cast<uint64_t>(p[2]) & kMask);
}

uint64_t packed(const VertexAttributes& a) {
  uint64_t out = 0;
  for (const uint8_t channel : a.colour) out = out << 8 | channel;
  for (const uint16_t coordinate : a.normal) out = out << 16 | coordinate;
  return out;
}

// Each triangle rotated to its smallest spelling, and all of them sorted. cornerOf(vertex) names
// what is compared of a corner.
template <typename CornerOf>
auto canonical(std::span<const Triangle> triangles, const CornerOf& cornerOf) {
  using Placed = std::array<decltype(cornerOf(0)), 3>;
  std::vector<Placed> placed;
  placed.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const auto a = cornerOf(t[0]);
    const auto b = cornerOf(t[1]);
    const auto c = cornerOf(t[2]);
    placed.push_back(std::min({Placed{a, b, c}, Placed{b, c, a}, Placed{c, a, b}}));
  }
  std::sort(placed.begin(), placed.end());
  return placed;
}

template <typename Placed>
TriangleSetDifference difference(const std::vector<Placed>& first,
                                 const std::vector<Placed>& second) {
  TriangleSetDifference out;
  auto a = first.begin();
  auto b = second.begin();
  while (a != first.end() && b != second.end()) {
    if (*a == *b) {
      ++a;
      ++b;
    } else if (*a < *b) {
      ++out.missingInSecond;
      ++a;
    } else {
      ++out.missingInFirst;
      ++b;
    }
  }
  out.missingInSecond += static_cast<size_t>(first.end() - a);
  out.missingInFirst += static_cast<size_t>(second.end() - b);
  return out;
}

}  // namespace

TriangleSetDifference compareTriangles(std::span<const GridPosition> firstPositions,
                                       std::span<const Triangle> firstTriangles,
                                       std::span<const GridPosition> secondPositions,
                                       std::span<const Triangle> secondTriangles) {
  const auto sorted = [](std::span<const GridPosition> positions,
                         std::span<const Triangle> triangles) {
    return canonical(triangles, [&](uint32_t v) { return packed(positions[v]); });
  };
  return difference(sorted(firstPositions, firstTriangles),
                    sorted(secondPositions, secondTriangles));
}

TriangleSetDifference compareMeshes(const GridMesh& first, const GridMesh& second) {
  if (first.attributes.empty() || second.attributes.empty())
    return compareTriangles(first.positions, first.triangles, second.positions, second.triangles);
  const auto sorted = [](const GridMesh& mesh) {
    return canonical(mesh.triangles, [&](uint32_t v) {
      return std::array<uint64_t, 2>{packed(mesh.positions[v]), packed(mesh.attributes[v])};
    });
  };
  return difference(sorted(first), sorted(second));
}

}  // namespace meshfront
