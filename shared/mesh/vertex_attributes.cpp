#include "shared/mesh/vertex_attributes.h"

#include <algorithm>
#include <cmath>

namespace meshfront {

std::vector<VertexAttributes> packAttributes(std::span<const Colour> colours,
                                             std::span<const std::array<float, 3>> normals,
                                             const AttributeLayout& layout) {
  std::vector<VertexAttributes> out(layout.any() ? std::max(colours.size(), normals.size()) : 0);
  for (size_t v = 0; v < out.size(); ++v) {
    if (layout.colours && v < colours.size()) out[v].colour = colours[v];
    if (layout.normalBits != 0 && v < normals.size())
      out[v].normal = toOctahedral(normals[v], layout.normalBits);
  }
  return out;
}

namespace {

OctahedralNormal folded(const std::array<float, 3>& normal, unsigned bits) {
  const double sum =
      std::abs(double{normal[0]}) + std::abs(double{normal[1]}) + std::abs(double{normal[2]});
  if (!(sum > 0)) return folded({0, 0, 1}, bits);
  double x = normal[0] / sum;
  double y = normal[1] / sum;
  if (normal[2] < 0) {
    const double foldedX = (1 - std::abs(y)) * (x < 0 ? -1 : 1);
    y = (1 - std::abs(x)) * (y < 0 ? -1 : 1);
    x = foldedX;
  }
  const double steps = (1U << bits) - 1;
  const auto toStep = [&](double v) {
    return static_cast<uint16_t>(std::clamp(std::floor((v + 1) / 2 * steps + 0.5), 0.0, steps));
  };
  return {toStep(x), toStep(y)};
}

}  // namespace

OctahedralNormal toOctahedral(const std::array<float, 3>& normal, unsigned bits) {
  // On the square's rim two points mean one direction. Going there and back settles which.
  const OctahedralNormal first = folded(normal, bits);
  return folded(fromOctahedral(first, bits), bits);
}

std::array<float, 3> fromOctahedral(const OctahedralNormal& normal, unsigned bits) {
  const double steps = (1U << bits) - 1;
  double x = normal[0] / steps * 2 - 1;
  double y = normal[1] / steps * 2 - 1;
  const double z = 1 - std::abs(x) - std::abs(y);
  if (z < 0) {
    const double foldedX = (1 - std::abs(y)) * (x < 0 ? -1 : 1);
    y = (1 - std::abs(x)) * (y < 0 ? -1 : 1);
    x = foldedX;
  }
  const double length = std::sqrt(x * x + y * y + z * z);
  return {static_cast<float>(x / length), static_cast<float>(y / length),
          static_cast<float>(z / length)};
}

}  // namespace meshfront
