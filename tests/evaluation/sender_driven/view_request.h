// What a sender-driven client tells of its view: the matrix, field of view, aspect, tolerance and
// the height of its picture. 62 octets on the wire.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/camera/camera.h"
#include "shared/mesh/quantization.h"
#include "shared/result.h"

namespace meshfront::evaluation {

struct ViewRequest {
  // From grid coordinates of the mesh to the view's (x right, y up, -z forward), in grid steps;
  // three rows of a rotation and a translation. Floats do, since both ends know the grid.
  std::array<float, 12> viewFromGrid{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  float verticalFov = 0.61F;  // radians
  float aspect = 1;
  float tolerance = 1;         // pixels of screen-space error that may stay, >= 0
  uint16_t pictureHeight = 1;  // pixels
  // When all that the view asks for has been sent: the rest, by geometric error.
  bool everything = false;

  // `tolerance` 0: all that the view may show.
  [[nodiscard]] static ViewRequest of(const Camera& camera, PixelSize picture,
                                      const Quantization& quantization, float tolerance);
  [[nodiscard]] std::vector<uint8_t> toBytes() const;
  // Untrusted: numbers that are no view (not finite, no rotation) are refused.
  [[nodiscard]] static Result<ViewRequest> fromBytes(std::span<const uint8_t> bytes);

  static constexpr size_t kBytes = 12 * 4 + 3 * 4 + 2;
};

}  // namespace meshfront::evaluation
