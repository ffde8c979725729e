// Step 4 of cleaning: one fan of faces a vertex.
#pragma once

#include <vector>

#include "encoder/cleaning/close_mesh.h"
#include "encoder/cleaning/half_edges.h"
#include "encoder/cleaning/vertex_copies.h"

namespace meshfront {

// The fan that holds a vertex's first corner keeps the vertex; every other one gets a copy. Twins
// stay as they are.
void splitIntoFans(VertexCopies& vertices, std::vector<Triangle>& triangles,
                   const std::vector<HalfEdge>& twins, CleaningReport& report);

}  // namespace meshfront
