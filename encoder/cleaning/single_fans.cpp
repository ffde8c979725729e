#include "encoder/cleaning/single_fans.h"

namespace meshfront {
namespace {

// The first half-edge, clockwise, of the fan of half-edges that start where h does; h itself if the
// fan is closed.
HalfEdge firstOfFan(const std::vector<HalfEdge>& twins, HalfEdge h) {
  HalfEdge first = h;
  while (twins[first] != kNoTwin) {
    first = nextInFace(twins[first]);
    if (first == h) break;
  }
  return first;
}

}  // namespace

void splitIntoFans(VertexCopies& vertices, std::vector<Triangle>& triangles,
                   const std::vector<HalfEdge>& twins, CleaningReport& report) {
  std::vector<bool> cornerDone(twins.size());
  std::vector<bool> vertexTaken(vertices.count());
  for (HalfEdge h = 0; h < twins.size(); ++h) {
    if (cornerDone[h]) continue;
    uint32_t vertex = originOf(triangles, h);
    if (vertexTaken[vertex]) {
      vertex = vertices.copy(vertex);
      ++report.verticesSplit;
    } else {
      vertexTaken[vertex] = true;
    }
    const HalfEdge first = firstOfFan(twins, h);
    HalfEdge corner = first;
    do {
      cornerDone[corner] = true;
      triangles[corner / 3][corner % 3] = vertex;
      corner = twins[previousInFace(corner)];
    } while (corner != kNoTwin && corner != first);
  }
}

}  // namespace meshfront
