// Visual importance of front vertices without a GPU or a picture: an estimate of what PixelCounter
// counts, fast enough for thousands of receivers in one process.
//
// Vertices are projected; a triangle that faces the eye counts its projected area in pixels for
// each of its three corners, cut down to the share of its bounding box that lies in the picture.
// A vertex's sum is rounded: less than half a pixel counts as nothing. What differs from a picture:
//  - parts that are hidden behind others, but face the eye, count. A receiver that ranks so asks
//    for more than one with a GPU before it settles, never for less of what is seen.
//  - triangles that face away count nothing, so a sheet seen from behind is not seen at all.
//  - a triangle that reaches through the eye's plane counts kCrossingPixels.
// O(vertices + triangles) of the front, about 10 ns each. Not thread-safe: it reuses its storage.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/camera/bounds.h"
#include "shared/camera/camera.h"
#include "shared/mesh/quantization.h"
#include "shared/refinement/selectively_refined_mesh.h"

namespace meshfront {

inline constexpr float kCrossingPixels = 64;

class ProjectedPixels {
 public:
  // By vertex slot; valid until the next call. `bounds`: of the mesh, world.
  [[nodiscard]] std::span<const uint32_t> count(const SelectivelyRefinedMesh& mesh,
                                                const Quantization& quantization,
                                                const Bounds& bounds, const Camera& camera,
                                                PixelSize picture);

 private:
  struct Projected {
    float x = 0;  // pixels from the picture's lower left corner; NaN: not in front of the eye
    float y = 0;
  };
  void project(std::span<const GridPosition> positions, const Quantization& quantization,
               const Projection& projection, PixelSize picture);
  [[nodiscard]] float pixelsOf(const Triangle& triangle, float width, float height) const;

  std::vector<Projected> projected_;  // by vertex slot
  std::vector<float> sums_;           // likewise
  std::vector<uint32_t> counts_;      // likewise
};

}  // namespace meshfront
