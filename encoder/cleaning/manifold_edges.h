// Step 3 of cleaning: which faces are joined along which edges.
#pragma once

#include <vector>

#include "encoder/cleaning/close_mesh.h"
#include "encoder/cleaning/half_edges.h"

namespace meshfront {

// By half-edge its twin: the other one between the same two vertices if there is exactly one other
// and it runs the other way; else kNoTwin.
[[nodiscard]] std::vector<HalfEdge> joinManifoldEdges(size_t vertexCount,
                                                      const std::vector<Triangle>& triangles,
                                                      CleaningReport& report);

}  // namespace meshfront
