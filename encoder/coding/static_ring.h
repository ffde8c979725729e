// The static ring of a node: the ring of its patch of leaves in the full mesh, which every
// receiver's ring is a merged version of (ring_cut.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "encoder/coding/closed_connectivity.h"
#include "encoder/hierarchy/vertex_forest.h"
#include "shared/codec/ring_cut.h"

namespace meshfront {

struct StaticRing {
  std::vector<uint32_t> leaves;  // entries: vertices around the patch; entry 0 is l
  std::vector<uint32_t> gaps;    // faces with one corner in the patch; gap i joins i and i + 1
  uint32_t right = 0;            // the entry that is r
};

// Walks once around the patch of leaves under the split node, counter-clockwise from f_l.
void walkStaticRing(ForestNode node, std::span<const Triangle> triangles,
                    std::span<const uint32_t> twins, const VertexForest& forest,
                    const FaceOrigins& origins, StaticRing& out);

}  // namespace meshfront
