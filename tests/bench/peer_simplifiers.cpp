#include "tests/bench/peer_simplifiers.h"

#include <meshoptimizer.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <limits>

namespace meshfront {

Simplified openMeshDecimated(const BenchMesh& mesh, size_t vertices) {
  using Mesh = OpenMesh::TriMesh_ArrayKernelT<>;
  const double start = processorSeconds();
  Mesh open;
  for (const GridPosition& p : mesh.positions) {
    open.add_vertex(
        Mesh::Point(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])));
  }
  std::vector<Mesh::VertexHandle> corners(3);
  for (const Triangle& t : mesh.drawn()) {
    for (size_t i = 0; i < 3; ++i) corners[i] = Mesh::VertexHandle(static_cast<int>(t[i]));
    open.add_face(corners);
  }
  OpenMesh::Decimater::DecimaterT<Mesh> decimater(open);
  OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
  decimater.add(quadric);
  decimater.module(quadric).unset_max_err();
  decimater.initialize();
  decimater.decimate_to(vertices);
  Simplified out;
  out.seconds = processorSeconds() - start;
  for (const Mesh::FaceHandle face : open.faces()) {  // skips deleted ones
    Triangle t{};
    size_t i = 0;
    for (const Mesh::VertexHandle v : open.fv_range(face)) t[i++] = static_cast<uint32_t>(v.idx());
    out.triangles.push_back(t);
  }
  return out;
}

Simplified meshoptSimplified(const BenchMesh& mesh, size_t triangles) {
  const double start = processorSeconds();
  std::vector<std::array<float, 3>> positions;
  positions.reserve(mesh.positions.size());
  for (const GridPosition& p : mesh.positions) {
    positions.push_back(
        {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  }
  Simplified out;
  out.triangles.resize(mesh.drawn().size());
  const size_t indices = meshopt_simplify(out.triangles.front().data(), mesh.drawn().front().data(),
                                          mesh.drawn().size() * 3, positions.front().data(),
                                          positions.size(), sizeof positions.front(), triangles * 3,
                                          std::numeric_limits<float>::max(), 0, nullptr);
  out.triangles.resize(indices / 3);
  out.seconds = processorSeconds() - start;
  return out;
}

Simplified meshoptWithVertices(const BenchMesh& mesh, size_t vertices) {
  constexpr int kSteps = 12;
  size_t low = 0;  // triangles; enough for no more than `vertices`
  size_t high = 3 * vertices;
  Simplified best;
  for (int step = 0; step < kSteps && low + 1 < high; ++step) {
    const size_t middle = step == 0 ? std::min(2 * vertices, high - 1) : low + (high - low) / 2;
    Simplified found = meshoptSimplified(mesh, middle);
    if (countVertices(found.triangles) <= vertices) {
      low = middle;
      best = std::move(found);
    } else {
      high = middle;
      if (best.triangles.empty()) best = std::move(found);  // nothing smaller so far
    }
  }
  return best;
}

}  // namespace meshfront
