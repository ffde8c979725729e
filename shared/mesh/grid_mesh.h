// A mesh as it is published: everything about it an integer, so that "exact" has a meaning.
#pragma once

#include <vector>

#include "shared/mesh/indexed_mesh.h"
#include "shared/mesh/quantization.h"
#include "shared/mesh/vertex_attributes.h"

namespace meshfront {

struct GridMesh {
  std::vector<GridPosition> positions{};
  std::vector<Triangle> triangles{};  // indices into positions
  AttributeLayout layout{};
  std::vector<VertexAttributes> attributes{};  // one a position, or empty if the layout is
};

}  // namespace meshfront
