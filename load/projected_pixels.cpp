#include "load/projected_pixels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <limits>

namespace meshfront {
namespace {

constexpr float kBehindTheEye = std::numeric_limits<float>::quiet_NaN();

// Three arguments, so that no branch is taken for what is as likely as not.
float leastOf(float a, float b, float c) {
  return std::min(std::min(a, b), c);
}
float mostOf(float a, float b, float c) {
  return std::max(std::max(a, b), c);
}

// How much of [low, high] lies in [0, side].
float shareInside(float low, float high, float side) {
  const float inside = std::min(high, side) - std::max(low, 0.0F);
  if (inside <= 0) return 0;
  const float length = high - low;
  return length <= inside ? 1 : inside / length;
}

}  // namespace

void ProjectedPixels::project(std::span<const GridPosition> positions,
                              const Quantization& quantization, const Projection& projection,
                              PixelSize picture) {
  // Relative to the grid point nearest to the eye, as the renderer does, so that floats suffice.
  const glm::dvec3& eye = projection.camera.eye;
  const GridPosition anchor = quantization.toGrid({eye.x, eye.y, eye.z});
  const std::array<double, 3> world = quantization.toWorld(anchor);
  glm::dmat4 scale(quantization.step);
  scale[3][3] = 1;
  const glm::mat4 clip(projection.clipFrom({world[0], world[1], world[2]}) * scale);
  const auto nearPlane = static_cast<float>(projection.nearPlane);
  const float halfWidth = 0.5F * static_cast<float>(picture.width);
  const float halfHeight = 0.5F * static_cast<float>(picture.height);
  projected_.resize(positions.size());
  for (size_t i = 0; i < positions.size(); ++i) {
    const GridPosition& p = positions[i];
    const glm::vec4 at =
        clip * glm::vec4(static_cast<float>(p[0] - anchor[0]), static_cast<float>(p[1] - anchor[1]),
                         static_cast<float>(p[2] - anchor[2]), 1.0F);
    Projected& out = projected_[i];
    out.x = at.w >= nearPlane ? (at.x / at.w + 1) * halfWidth : kBehindTheEye;
    out.y = (at.y / at.w + 1) * halfHeight;
  }
}

float ProjectedPixels::pixelsOf(const Triangle& triangle, float width, float height) const {
  const Projected& a = projected_[triangle[0]];
  const Projected& b = projected_[triangle[1]];
  const Projected& c = projected_[triangle[2]];
  const float twice = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
  if (!(twice > 0)) {
    if (!std::isnan(twice)) return 0;
    const bool allBehind = std::isnan(a.x) && std::isnan(b.x) && std::isnan(c.x);
    return allBehind ? 0 : kCrossingPixels;
  }
  const float left = leastOf(a.x, b.x, c.x);
  const float right = mostOf(a.x, b.x, c.x);
  const float low = leastOf(a.y, b.y, c.y);
  const float high = mostOf(a.y, b.y, c.y);
  if (left >= 0 && right <= width && low >= 0 && high <= height) return 0.5F * twice;
  return 0.5F * twice * shareInside(left, right, width) * shareInside(low, high, height);
}

std::span<const uint32_t> ProjectedPixels::count(const SelectivelyRefinedMesh& mesh,
                                                 const Quantization& quantization,
                                                 const Bounds& bounds, const Camera& camera,
                                                 PixelSize picture) {
  const Projection projection = Projection::fit(camera, bounds, picture.aspect());
  project(mesh.positions(), quantization, projection, picture);
  sums_.assign(projected_.size(), 0);
  const auto width = static_cast<float>(picture.width);
  const auto height = static_cast<float>(picture.height);
  for (const Triangle& triangle : mesh.drawnCorners()) {
    if (triangle[0] == triangle[1]) continue;  // not drawn
    const float pixels = pixelsOf(triangle, width, height);
    if (pixels <= 0) continue;
    for (const uint32_t corner : triangle) sums_[corner] += pixels;
  }
  constexpr float kMost = 1e9F;
  counts_.resize(sums_.size());
  for (size_t i = 0; i < sums_.size(); ++i)
    counts_[i] = static_cast<uint32_t>(std::min(sums_[i], kMost) + 0.5F);
  return counts_;
}

}  // namespace meshfront
