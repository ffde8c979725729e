// The mesh as refined so far, as a file.
#pragma once

#include <filesystem>

#include "shared/mesh/quantization.h"
#include "shared/refinement/selectively_refined_mesh.h"
#include "shared/result.h"

namespace meshfront {

// The front's triangles in world coordinates, as binary PLY.
[[nodiscard]] Result<void> exportMesh(const SelectivelyRefinedMesh& mesh,
                                      const Quantization& quantization,
                                      const std::filesystem::path& path);

}  // namespace meshfront
