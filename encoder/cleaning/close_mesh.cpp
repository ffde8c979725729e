#include "encoder/cleaning/close_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "encoder/cleaning/distinct_faces.h"
#include "encoder/cleaning/half_edges.h"
#include "encoder/cleaning/manifold_edges.h"
#include "encoder/cleaning/single_fans.h"
#include "encoder/cleaning/vertex_copies.h"
#include "shared/mesh/weld_positions.h"

namespace meshfront {
namespace {

constexpr uint32_t kUnused = UINT32_MAX;
// Closing may quadruple the triangles, and half-edges are numbered by 32 bits.
constexpr size_t kMaxTriangles = UINT32_MAX / 12;

// Numbers the vertices that triangles use anew, in order; by new number the vertex.
std::vector<uint32_t> keepReferenced(size_t vertexCount, std::vector<Triangle>& triangles) {
  std::vector<uint32_t> newIndex(vertexCount, kUnused);
  for (const Triangle& t : triangles)
    for (const uint32_t corner : t) newIndex[corner] = 0;
  std::vector<uint32_t> kept;
  for (uint32_t vertex = 0; vertex < vertexCount; ++vertex) {
    if (newIndex[vertex] == kUnused) continue;
    newIndex[vertex] = static_cast<uint32_t>(kept.size());
    kept.push_back(vertex);
  }
  for (Triangle& t : triangles)
    for (uint32_t& corner : t) corner = newIndex[corner];
  return kept;
}

// The elements of `all` (if there are any) that `which` names.
template <typename T>
std::vector<T> chosen(std::vector<T> all, const std::vector<uint32_t>& which) {
  if (all.empty()) return all;
  const auto isItself = [i = uint32_t{0}](uint32_t chosenOne) mutable { return chosenOne == i++; };
  if (which.size() == all.size() && std::all_of(which.begin(), which.end(), isItself)) return all;
  std::vector<T> out;
  out.reserve(which.size());
  for (const uint32_t i : which) out.push_back(all[i]);
  return out;
}

// By welded vertex the first vertex of the input that is there.
std::vector<uint32_t> firstOccurrences(const WeldedPositions& welded) {
  std::vector<uint32_t> first;
  first.reserve(welded.positions.size());
  for (uint32_t vertex = 0; vertex < welded.indexOf.size(); ++vertex)
    if (welded.indexOf[vertex] == first.size()) first.push_back(vertex);
  return first;
}

uint64_t countWeldedDifferently(const IndexedMesh& mesh, const std::vector<uint32_t>& indexOf,
                                const std::vector<uint32_t>& first) {
  uint64_t count = 0;
  if (mesh.colours.empty() && mesh.normals.empty()) return count;
  for (size_t vertex = 0; vertex < indexOf.size(); ++vertex) {
    const uint32_t stays = first[indexOf[vertex]];
    const bool same = (mesh.colours.empty() || mesh.colours[vertex] == mesh.colours[stays]) &&
                      (mesh.normals.empty() || mesh.normals[vertex] == mesh.normals[stays]);
    if (!same) ++count;
  }
  return count;
}

bool extentIsFinite(const std::vector<std::array<double, 3>>& positions) {
  for (size_t axis = 0; axis < 3; ++axis) {
    double low = 0;
    double high = 0;
    for (const auto& p : positions) {
      low = std::min(low, p[axis]);
      high = std::max(high, p[axis]);
    }
    if (!std::isfinite(high - low)) return false;
  }
  return true;
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

Result<ClosedMesh> closeMesh(IndexedMesh mesh, CleaningReport& report) {
  report = {};
  report.verticesIn = mesh.positions.size();
  report.trianglesIn = mesh.triangles.size();
  if (mesh.triangles.size() > kMaxTriangles || mesh.positions.size() > kMaxTriangles)
    return fail(ErrorCode::tooLarge, "cleaning: more than " + std::to_string(kMaxTriangles) +
                                         " triangles or vertices; cut the mesh into parts");
  if ((!mesh.colours.empty() && mesh.colours.size() != mesh.positions.size()) ||
      (!mesh.normals.empty() && mesh.normals.size() != mesh.positions.size()))
    return fail("cleaning: not as many colours or normals as vertices");
  if (!extentIsFinite(mesh.positions))
    return fail("cleaning: the coordinates lie too far apart for 64-bit numbers; scale the mesh");
  ClosedMesh closed;
  closed.triangles = std::move(mesh.triangles);
  std::vector<uint32_t> inputVertex;  // by welded vertex
  {
    const auto welded = weldPositions(mesh.positions);
    report.weldedVertices = mesh.positions.size() - welded.positions.size();
    for (Triangle& t : closed.triangles) {
      for (uint32_t& corner : t) {
        if (corner >= welded.indexOf.size())
          return fail("cleaning: vertex index " + std::to_string(corner) + " is out of range");
        corner = welded.indexOf[corner];
      }
    }
    inputVertex = firstOccurrences(welded);
    report.weldedDifferently = countWeldedDifferently(mesh, welded.indexOf, inputVertex);
  }

  VertexCopies vertices(inputVertex.size());
  keepDistinctFaces(vertices, closed.triangles, report);
  if (closed.triangles.empty())
    return fail("cleaning: no triangle with three different corners is left");
  const auto twins = joinManifoldEdges(vertices.count(), closed.triangles, report);
  splitIntoFans(vertices, closed.triangles, twins, report);
  auto kept = keepReferenced(vertices.count(), closed.triangles);
  report.unreferencedVertices = vertices.count() - kept.size();
  for (uint32_t& vertex : kept) vertex = inputVertex[vertices.originalOf(vertex)];
  closed.positions = chosen(std::move(mesh.positions), kept);
  closed.colours = chosen(std::move(mesh.colours), kept);
  closed.normals = chosen(std::move(mesh.normals), kept);
  closed.realTriangleCount = closed.triangles.size();
  closeLoops(closed, twins, report);
  report.components = countComponents(closed);
  return closed;
}

}  // namespace meshfront
