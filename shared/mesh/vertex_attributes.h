// What vertices carry beside a position, as the codec stores it: integers, exact from then on.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/mesh/indexed_mesh.h"

namespace meshfront {

inline constexpr unsigned kMinNormalBits = 4;
inline constexpr unsigned kMaxNormalBits = 15;
inline constexpr unsigned kDefaultNormalBits = 10;

// A unit vector folded onto an octahedron and flattened to a square of 2^bits by 2^bits steps
// (Meyer, Suessmuth, Sussner, Stamminger and Greiner, On floating-point normal vectors, EGSR 2010).
using OctahedralNormal = std::array<uint16_t, 2>;

struct AttributeLayout {
  bool colours = false;     // red, green, blue, alpha, 8 bits each
  unsigned normalBits = 0;  // of each of the two coordinates; 0: no normals

  [[nodiscard]] bool any() const { return colours || normalBits != 0; }
  friend bool operator==(const AttributeLayout&, const AttributeLayout&) = default;
};

struct VertexAttributes {
  Colour colour{0, 0, 0, 255};  // of no meaning without colours, likewise the normal
  OctahedralNormal normal{};

  friend bool operator==(const VertexAttributes&, const VertexAttributes&) = default;
};

// What vertices carry, in this layout: both spans are empty or of one length; what the layout lacks
// is left out. Empty without any attribute.
[[nodiscard]] std::vector<VertexAttributes> packAttributes(
    std::span<const Colour> colours, std::span<const std::array<float, 3>> normals,
    const AttributeLayout& layout);

// `normal` of any length; zero, which has no direction, becomes +z. `bits` as in AttributeLayout.
[[nodiscard]] OctahedralNormal toOctahedral(const std::array<float, 3>& normal, unsigned bits);
// Of unit length.
[[nodiscard]] std::array<float, 3> fromOctahedral(const OctahedralNormal& normal, unsigned bits);

}  // namespace meshfront
