#include "shared/mesh/same_triangles.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace meshfront {
namespace {

using PlacedTriangle = std::array<uint64_t, 3>;  // its corners' positions, packed

uint64_t packed(const GridPosition& p) {
  constexpr uint64_t kMask = (1U << 21) - 1;
  return (static_cast<uint64_t>(p[0]) & kMask) << 42 | (static_cast<uint64_t>(p[1]) & kMask) << 21 |
         (static_cast<uint64_t>(p[2]) & kMask);
}

// Each triangle rotated to its smallest spelling, and all of them sorted.
std::vector<PlacedTriangle> canonical(std::span<const GridPosition> positions,
                                      std::span<const Triangle> triangles) {
  std::vector<PlacedTriangle> placed;
  placed.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const uint64_t a = packed(positions[t[0]]);
    const uint64_t b = packed(positions[t[1]]);
    const uint64_t c = packed(positions[t[2]]);
    placed.push_back(
        std::min({PlacedTriangle{a, b, c}, PlacedTriangle{b, c, a}, PlacedTriangle{c, a, b}}));
  }
  std::sort(placed.begin(), placed.end());
  return placed;
}

}  // namespace

TriangleSetDifference compareTriangles(std::span<const GridPosition> firstPositions,
                                       std::span<const Triangle> firstTriangles,
                                       std::span<const GridPosition> secondPositions,
                                       std::span<const Triangle> secondTriangles) {
  const auto first = canonical(firstPositions, firstTriangles);
  const auto second = canonical(secondPositions, secondTriangles);
  TriangleSetDifference difference;
  auto a = first.begin();
  auto b = second.begin();
  while (a != first.end() && b != second.end()) {
    if (*a == *b) {
      ++a;
      ++b;
    } else if (*a < *b) {
      ++difference.missingInSecond;
      ++a;
    } else {
      ++difference.missingInFirst;
      ++b;
    }
  }
  difference.missingInSecond += static_cast<size_t>(first.end() - a);
  difference.missingInFirst += static_cast<size_t>(second.end() - b);
  return difference;
}

}  // namespace meshfront
