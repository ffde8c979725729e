#include "encoder/cleaning/close_mesh.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "encoder/cleaning/distinct_faces.h"
#include "encoder/cleaning/half_edges.h"
#include "encoder/cleaning/manifold_edges.h"
#include "encoder/cleaning/single_fans.h"
#include "shared/mesh/weld_positions.h"

namespace meshfront {
namespace {

constexpr uint32_t kUnused = UINT32_MAX;
// Closing may quadruple the triangles, and half-edges are numbered by 32 bits.
constexpr size_t kMaxTriangles = UINT32_MAX / 12;

void dropUnreferenced(std::vector<std::array<double, 3>>& positions,
                      std::vector<Triangle>& triangles, CleaningReport& report) {
  std::vector<uint32_t> newIndex(positions.size(), kUnused);
  for (const Triangle& t : triangles)
    for (const uint32_t corner : t) newIndex[corner] = 0;
  uint32_t kept = 0;
  for (size_t vertex = 0; vertex < positions.size(); ++vertex) {
    if (newIndex[vertex] == kUnused) continue;
    positions[kept] = positions[vertex];
    newIndex[vertex] = kept++;
  }
  report.unreferencedVertices = positions.size() - kept;
  positions.resize(kept);
  for (Triangle& t : triangles)
    for (uint32_t& corner : t) corner = newIndex[corner];
}

// Joins loops of two boundary edges and closes longer ones. After the split into fans each vertex
// starts at most one boundary half-edge and ends at most one, so that boundaries are simple loops.
// Two edges between the same two vertices come from one cut edge of the input (all others are
// unique), so both are boundary, both fans end at them, and they are a loop of two. Joining it
// leaves a single edge; the fans stay larger than two because no two faces share all corners.
void closeLoops(ClosedMesh& mesh, const std::vector<HalfEdge>& twins, CleaningReport& report) {
  std::vector<HalfEdge> boundaryFrom(mesh.positions.size(), kNoTwin);
  for (HalfEdge h = 0; h < twins.size(); ++h)
    if (twins[h] == kNoTwin) boundaryFrom[originOf(mesh.triangles, h)] = h;
  for (HalfEdge h = 0; h < twins.size(); ++h) {
    const uint32_t start = originOf(mesh.triangles, h);
    if (twins[h] != kNoTwin || boundaryFrom[start] == kNoTwin) continue;
    const uint32_t second = targetOf(mesh.triangles, h);
    if (targetOf(mesh.triangles, boundaryFrom[second]) == start) {
      boundaryFrom[start] = boundaryFrom[second] = kNoTwin;
      ++report.rejoinedEdges;
      continue;
    }
    const auto apex = static_cast<uint32_t>(mesh.vertexCount());
    ++mesh.virtualCount;
    uint32_t from = start;
    do {
      const HalfEdge edge = std::exchange(boundaryFrom[from], kNoTwin);
      const uint32_t to = targetOf(mesh.triangles, edge);
      mesh.triangles.push_back({to, from, apex});
      from = to;
    } while (from != start);
  }
  report.boundaryLoops = mesh.virtualCount;
}

uint64_t countComponents(const ClosedMesh& mesh) {
  std::vector<uint32_t> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&parent](uint32_t vertex) {
    while (parent[vertex] != vertex) vertex = parent[vertex] = parent[parent[vertex]];
    return vertex;
  };
  uint64_t components = parent.size();
  for (size_t i = 0; i < mesh.realTriangleCount; ++i) {
    const Triangle& t = mesh.triangles[i];
    for (const uint32_t other : {t[1], t[2]}) {
      const uint32_t a = root(t[0]);
      const uint32_t b = root(other);
      if (a == b) continue;
      parent[std::max(a, b)] = std::min(a, b);
      --components;
    }
  }
  return components;
}

}  // namespace

Result<ClosedMesh> closeMesh(const IndexedMesh& mesh, CleaningReport& report) {
  report = {};
  report.verticesIn = mesh.positions.size();
  report.trianglesIn = mesh.triangles.size();
  if (mesh.triangles.size() > kMaxTriangles || mesh.positions.size() > kMaxTriangles)
    return fail(ErrorCode::tooLarge, "cleaning: more than " + std::to_string(kMaxTriangles) +
                                         " triangles or vertices; cut the mesh into parts");
  auto welded = weldPositions(mesh.positions);
  report.weldedVertices = mesh.positions.size() - welded.positions.size();
  ClosedMesh closed;
  closed.positions = std::move(welded.positions);
  closed.triangles = mesh.triangles;
  for (Triangle& t : closed.triangles) {
    for (uint32_t& corner : t) {
      if (corner >= welded.indexOf.size())
        return fail("cleaning: vertex index " + std::to_string(corner) + " is out of range");
      corner = welded.indexOf[corner];
    }
  }
  welded.indexOf = {};

  keepDistinctFaces(closed.positions, closed.triangles, report);
  if (closed.triangles.empty())
    return fail("cleaning: no triangle with three different corners is left");
  const auto twins = joinManifoldEdges(closed.positions.size(), closed.triangles, report);
  splitIntoFans(closed.positions, closed.triangles, twins, report);
  dropUnreferenced(closed.positions, closed.triangles, report);
  closed.realTriangleCount = closed.triangles.size();
  closeLoops(closed, twins, report);
  report.components = countComponents(closed);
  return closed;
}

}  // namespace meshfront
