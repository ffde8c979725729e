// The quadric error of a vertex, kept relative to that vertex's own position. So the error at the
// vertex is the constant term alone, a fresh vertex has nothing but the matrix, and single
// precision is enough: offsets are edge lengths, never coordinates.
#pragma once

#include <array>

namespace meshfront {

using Offset = std::array<float, 3>;

struct VertexQuadric {
  float xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;  // matrix
  float x = 0, y = 0, z = 0;                             // half the gradient
  float constant = 0;

  // Adds `weight` times the squared distance to a plane through the vertex with this unit normal.
  void addPlane(const std::array<double, 3>& normal, double weight) {
    const auto [a, b, c] = normal;
    xx += static_cast<float>(weight * a * a);
    xy += static_cast<float>(weight * a * b);
    xz += static_cast<float>(weight * a * c);
    yy += static_cast<float>(weight * b * b);
    yz += static_cast<float>(weight * b * c);
    zz += static_cast<float>(weight * c * c);
  }
  // The error at this offset from the vertex. Rounding can make it slightly negative.
  [[nodiscard]] float at(float dx, float dy, float dz) const {
    return constant + dx * (xx * dx + 2 * (xy * dy + xz * dz + x)) +
           dy * (yy * dy + 2 * (yz * dz + y)) + dz * (zz * dz + 2 * z);
  }
  // Adds the quadric of a vertex from which this one lies at the given offset.
  void addMoved(const VertexQuadric& other, float dx, float dy, float dz) {
    const float moved = other.at(dx, dy, dz);
    constant += moved > 0 ? moved : 0;
    x += other.x + other.xx * dx + other.xy * dy + other.xz * dz;
    y += other.y + other.xy * dx + other.yy * dy + other.yz * dz;
    z += other.z + other.xz * dx + other.yz * dy + other.zz * dz;
    xx += other.xx;
    xy += other.xy;
    xz += other.xz;
    yy += other.yy;
    yz += other.yz;
    zz += other.zz;
  }
};

}  // namespace meshfront
