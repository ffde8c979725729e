// A mesh as it is published: cleaned as the encoder cleans, on a grid.
#pragma once

#include <filesystem>
#include <optional>

#include "shared/mesh/grid_mesh.h"
#include "shared/result.h"

namespace meshfront {

// Reads and cleans a mesh file and puts it on `grid`, or on its own of `bits` bits if that is not
// given (then it is filled in). Of what its vertices carry it has what `layout` names.
[[nodiscard]] Result<GridMesh> publishedMesh(const std::filesystem::path& path,
                                             std::optional<Quantization>& grid, unsigned bits,
                                             const AttributeLayout& layout);

// Reads a mesh file as it is, an exported one say, and puts it on `grid`.
[[nodiscard]] Result<GridMesh> meshOnGrid(const std::filesystem::path& path,
                                          const Quantization& grid, const AttributeLayout& layout);

}  // namespace meshfront
