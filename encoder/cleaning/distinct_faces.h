// Step 1 and 2 of cleaning: which faces stay, on welded vertices.
#pragma once

#include <vector>

#include "encoder/cleaning/close_mesh.h"
#include "encoder/cleaning/vertex_copies.h"

namespace meshfront {

// Drops degenerate and repeated faces (order kept) and moves opposite duplicates to copies of their
// vertices. Afterwards no two faces share all three vertices.
void keepDistinctFaces(VertexCopies& vertices, std::vector<Triangle>& triangles,
                       CleaningReport& report);

}  // namespace meshfront
