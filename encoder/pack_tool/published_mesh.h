// A mesh as it is published: cleaned as the encoder cleans, on a grid.
#pragma once

#include <filesystem>
#include <optional>

#include "encoder/pack_tool/verify_pack.h"
#include "shared/mesh/quantization.h"
#include "shared/result.h"

namespace meshfront {

// Reads and cleans a mesh file and puts it on `grid`, or on its own of `bits` bits if that is not
// given (then it is filled in).
[[nodiscard]] Result<ExpectedMesh> publishedMesh(const std::filesystem::path& path,
                                                 std::optional<Quantization>& grid, unsigned bits);

// Reads a mesh file as it is, an exported one say, and puts it on `grid`.
[[nodiscard]] Result<ExpectedMesh> meshOnGrid(const std::filesystem::path& path,
                                              const Quantization& grid);

}  // namespace meshfront
