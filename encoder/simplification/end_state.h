// What holds the vertices that are left once no collapse is valid any more.
#pragma once

#include <vector>

#include "encoder/simplification/collapse_choice.h"
#include "encoder/simplification/collapsible_mesh.h"
#include "encoder/simplification/simplify.h"

namespace meshfront {

// One sweep over all vertices that are left and the directions they could go. The first realCount
// vertices are real. Time: each edge costs the smaller of its ends' valences. Memory: two bits a
// vertex.
[[nodiscard]] EndState sweepEndState(const CollapsibleMesh& mesh,
                                     const std::vector<SimplifyVertex>& vertices,
                                     uint32_t realCount, uint32_t maxValence);

}  // namespace meshfront
