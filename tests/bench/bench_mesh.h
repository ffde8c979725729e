// A mesh as the encoder simplifies it, cleaned and on its grid, for all simplifiers alike.
#pragma once

#include <string>
#include <vector>

#include "encoder/cleaning/close_mesh.h"
#include "shared/mesh/quantization.h"
#include "shared/result.h"

namespace meshfront {

struct BenchMesh {
  ClosedMesh closed;  // its double positions are gone
  std::vector<GridPosition> positions;

  // The triangles of the input, without those that close holes.
  [[nodiscard]] std::span<const Triangle> drawn() const {
    return {closed.triangles.data(), closed.realTriangleCount};
  }
};

[[nodiscard]] Result<BenchMesh> readBenchMesh(const std::string& path, unsigned bits);

// Processor time, which neighbours on the machine disturb less than they do the clock.
[[nodiscard]] double processorSeconds();

[[nodiscard]] size_t countVertices(std::span<const Triangle> triangles);

}  // namespace meshfront
