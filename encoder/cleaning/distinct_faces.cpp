#include "encoder/cleaning/distinct_faces.h"

#include <algorithm>

#include "encoder/cleaning/vertex_buckets.h"

namespace meshfront {
namespace {

enum class Fate : uint8_t { kept, repeated, opposite };

// A face in the bucket of its smallest corner.
struct FaceKey {
  uint32_t middle;  // corner
  uint32_t largest;
  uint32_t face;
  bool odd;  // the corners, sorted, are an odd permutation of the face's

  bool operator<(const FaceKey& other) const {
    if (middle != other.middle) return middle < other.middle;
    if (largest != other.largest) return largest < other.largest;
    return face < other.face;
  }
};

FaceKey keyOf(const Triangle& t, uint32_t face) {
  // Rotated so that the smallest corner comes first, the other two tell the orientation.
  const auto smallest = static_cast<size_t>(std::min_element(t.begin(), t.end()) - t.begin());
  const uint32_t second = t[(smallest + 1) % 3];
  const uint32_t third = t[(smallest + 2) % 3];
  return {std::min(second, third), std::max(second, third), face, second > third};
}

std::vector<Fate> fatesOf(size_t vertexCount, const std::vector<Triangle>& triangles) {
  std::vector<Fate> fates(triangles.size(), Fate::kept);
  const VertexBuckets buckets(
      vertexCount, static_cast<uint32_t>(triangles.size()), [&](uint32_t face) {
        return *std::min_element(triangles[face].begin(), triangles[face].end());
      });
  std::vector<FaceKey> keys;
  for (size_t vertex = 0; vertex < buckets.count(); ++vertex) {
    keys.clear();
    for (const uint32_t face : buckets[vertex]) keys.push_back(keyOf(triangles[face], face));
    std::sort(keys.begin(), keys.end());
    for (size_t first = 0; first < keys.size();) {
      bool oppositeSeen = false;
      size_t i = first + 1;
      for (; i < keys.size() && keys[i].middle == keys[first].middle &&
             keys[i].largest == keys[first].largest;
           ++i) {
        const bool opposite = keys[i].odd != keys[first].odd && !oppositeSeen;
        oppositeSeen = oppositeSeen || opposite;
        fates[keys[i].face] = opposite ? Fate::opposite : Fate::repeated;
      }
      first = i;
    }
  }
  return fates;
}

}  // namespace

void keepDistinctFaces(VertexCopies& vertices, std::vector<Triangle>& triangles,
                       CleaningReport& report) {
  report.degenerateFaces = std::erase_if(
      triangles, [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  const auto fates = fatesOf(vertices.count(), triangles);
  std::vector<uint32_t> secondLayer(
      std::find(fates.begin(), fates.end(), Fate::opposite) == fates.end() ? 0 : vertices.count(),
      UINT32_MAX);  // by vertex: its copy
  size_t kept = 0;
  for (size_t face = 0; face < fates.size(); ++face) {
    if (fates[face] == Fate::repeated) continue;
    Triangle t = triangles[face];
    if (fates[face] == Fate::opposite) {
      ++report.oppositeDuplicates;
      for (uint32_t& corner : t) {
        uint32_t& copy = secondLayer[corner];
        if (copy == UINT32_MAX) {
          copy = vertices.copy(corner);
          ++report.verticesSplit;
        }
        corner = copy;
      }
    }
    triangles[kept++] = t;
  }
  report.repeatedFaces = triangles.size() - kept;
  triangles.resize(kept);
}

}  // namespace meshfront
