#include "encoder/coding/static_ring.h"

namespace meshfront {

void walkStaticRing(ForestNode node, std::span<const Triangle> triangles,
                    std::span<const uint32_t> twins, const VertexForest& forest,
                    const FaceOrigins& origins, StaticRing& out) {
  const auto next = [](uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; };
  const auto previous = [](uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; };
  const auto origin = [&](uint32_t h) { return triangles[h / 3][h % 3]; };
  const auto patch = forest.leafRange(node);
  const auto inside = [&](uint32_t vertex) { return patch.holds(forest.leafRank(vertex)); };
  const uint32_t leftFace = origins.leftFace[node - forest.leafCount()];
  const uint32_t rightFace = origins.rightFace[node - forest.leafCount()];

  // f_l = (u, t, l): leave it through the edge l -> u, whose twin u -> l starts the walk.
  uint32_t outer = 3 * leftFace;
  while (inside(origin(outer))) ++outer;
  const uint32_t start = twins[outer];
  out.leaves.assign(1, origin(outer));
  out.gaps.clear();
  out.right = 0;
  // `h` runs from the patch to the current entry; its face is the next to cross.
  uint32_t h = start;
  do {
    const uint32_t face = h / 3;
    const uint32_t third = origin(previous(h));
    if (inside(third)) {
      if (face == rightFace) out.right = static_cast<uint32_t>(out.leaves.size()) - 1;
      h = twins[next(h)];
    } else {
      out.gaps.push_back(face);
      out.leaves.push_back(third);
      h = twins[previous(h)];
    }
  } while (h != start);
  out.leaves.pop_back();  // the walk ends where it began, at l
}

}  // namespace meshfront
