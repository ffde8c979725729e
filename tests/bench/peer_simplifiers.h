// Other simplifiers, to stand beside ours: OpenMesh's decimater with quadrics (half-edge collapses)
// and meshoptimizer's meshopt_simplify.
#pragma once

#include <vector>

#include "tests/bench/bench_mesh.h"

namespace meshfront {

struct Simplified {
  std::vector<Triangle> triangles;  // on the vertices of the input
  double seconds = 0;               // processor time, building its own mesh included
};

// Down to `vertices`, or as far as it goes.
[[nodiscard]] Simplified openMeshDecimated(const BenchMesh& mesh, size_t vertices);

// Down to `triangles`, or as far as it goes; it cannot be asked for vertices.
[[nodiscard]] Simplified meshoptSimplified(const BenchMesh& mesh, size_t triangles);
// The largest with at most `vertices` vertices, by bisection. The time is that of the last call.
[[nodiscard]] Simplified meshoptWithVertices(const BenchMesh& mesh, size_t vertices);

}  // namespace meshfront
