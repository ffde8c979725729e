// Distances between two triangle meshes: of points spread evenly over one from the surface of the
// other.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/mesh/indexed_mesh.h"

namespace meshfront {

using Point = std::array<double, 3>;

// A tree of bounding boxes around triangles. Views the mesh, which must outlive it.
class TriangleTree {
 public:
  // At least one triangle, with indices in range.
  TriangleTree(std::span<const Point> positions, std::span<const Triangle> triangles);

  // Of the point from the nearest triangle.
  [[nodiscard]] double distance(const Point& point) const;

 private:
  struct Node {
    Point low{}, high{};
    uint32_t first = 0;  // of a leaf: triangle; else: the second child, the first one follows
    uint32_t count = 0;  // of a leaf: its triangles; else 0
  };
  void build(uint32_t begin, uint32_t end, std::vector<Point>& centres);
  [[nodiscard]] double distance2(const Point& point, uint32_t triangle) const;

  std::span<const Point> positions_;
  std::span<const Triangle> triangles_;
  std::vector<uint32_t> order_;
  std::vector<Node> nodes_;
};

struct SurfaceDistance {
  double mean = 0;  // over the area of the mesh measured from
  double maximum = 0;
};

// From the triangles to the tree's surface: the mean over `samples` points that are spread over the
// area, the maximum over these and the corners. The same points each time.
[[nodiscard]] SurfaceDistance surfaceDistance(std::span<const Point> positions,
                                              std::span<const Triangle> triangles,
                                              const TriangleTree& to, size_t samples);

}  // namespace meshfront
