// A sphere with mountains, as large as one likes: an icosahedron refined evenly, displaced by
// fractal noise down to a few edges, with white noise on top as of a range scanner. It stands in
// for scans that are too large to keep beside the tests. Vertices and triangles are made one after
// another and never held together. The same on every machine: no library function but sqrt.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "shared/mesh/indexed_mesh.h"
#include "shared/result.h"

namespace meshfront {

class FractalSphere {
 public:
  // The smallest one of at least `vertices` (12 .. 2^31 - 1), with 10 f^2 + 2 vertices.
  // `scannerNoise`: largest displacement by the white noise, in edge lengths.
  FractalSphere(uint64_t vertices, uint64_t seed, double scannerNoise = 0.15);

  [[nodiscard]] uint64_t vertexCount() const { return 10 * uint64_t{perEdge_} * perEdge_ + 2; }
  [[nodiscard]] uint64_t triangleCount() const { return 20 * uint64_t{perEdge_} * perEdge_; }

  // Calls visit(std::array<double, 3>) for vertex 0, 1, 2 ...; the sphere has radius 1.
  template <typename Visit>
  void forEachVertex(const Visit& visit) const {
    uint32_t index = 0;
    for (uint32_t corner = 0; corner < kCorners; ++corner) visit(at(corners_[corner], index++));
    for (const auto& [from, to] : edges_) {
      for (uint32_t i = 1; i < perEdge_; ++i)
        visit(at(between(corners_[from], perEdge_ - i, corners_[to], i, {}, 0), index++));
    }
    for (const Triangle& face : faces_) {
      for (uint32_t j = 1; j + 1 < perEdge_; ++j) {
        for (uint32_t i = 1; i + j < perEdge_; ++i) {
          visit(at(between(corners_[face[0]], perEdge_ - i - j, corners_[face[1]], i,
                           corners_[face[2]], j),
                   index++));
        }
      }
    }
  }
  // Calls visit(Triangle) for all, counter-clockwise from outside, face by face of the icosahedron.
  template <typename Visit>
  void forEachTriangle(const Visit& visit) const {
    for (uint32_t face = 0; face < faces_.size(); ++face) {
      for (uint32_t j = 0; j < perEdge_; ++j) {
        for (uint32_t i = 0; i + j < perEdge_; ++i) {
          const uint32_t a = indexAt(face, i, j);
          const uint32_t b = indexAt(face, i + 1, j);
          const uint32_t c = indexAt(face, i, j + 1);
          visit(Triangle{a, b, c});
          if (i + j + 1 < perEdge_) visit(Triangle{b, indexAt(face, i + 1, j + 1), c});
        }
      }
    }
  }

 private:
  using Vector = std::array<double, 3>;
  static constexpr uint32_t kCorners = 12;

  static Vector between(const Vector& a, uint32_t weightA, const Vector& b, uint32_t weightB,
                        const Vector& c, uint32_t weightC);
  // The displaced point in this direction.
  [[nodiscard]] Vector at(const Vector& direction, uint32_t index) const;
  // The vertex i steps from the first corner of the face to the second, and j to the third.
  [[nodiscard]] uint32_t indexAt(uint32_t face, uint32_t i, uint32_t j) const;
  [[nodiscard]] uint32_t onEdge(uint32_t from, uint32_t to, uint32_t steps) const;

  uint32_t perEdge_ = 1;  // small edges on one of the icosahedron's
  uint64_t seed_;
  double noise_ = 0;  // largest white noise
  unsigned octaves_ = 1;
  std::array<Vector, kCorners> corners_{};
  std::vector<Triangle> faces_;
  std::vector<std::array<uint32_t, 2>> edges_;
  std::array<std::array<uint32_t, kCorners>, kCorners> edgeOf_{};
};

// Binary little-endian PLY with floats, a piece at a time. An Error (unavailable) names the file,
// which is then removed.
[[nodiscard]] Result<void> writeFractalSphere(const std::filesystem::path& path,
                                              const FractalSphere& sphere);

}  // namespace meshfront
