// What a person looks at comes first: by how many significance levels a vertex is ranked earlier
// than its own, because it stands near the middle of the picture (foveation) or near a spot that
// was asked for ("refine here").
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <optional>
#include <span>
#include <vector>

#include "shared/camera/camera.h"
#include "shared/mesh/quantization.h"

namespace meshfront {

struct Foveation {
  bool on = true;
  // In half heights of the picture: within `inner` the whole lift, from there to `outer` less.
  double inner = 0.25;
  double outer = 1.0;
  uint8_t levels = 2;
};

// A ball in the world whose inside is wanted first.
struct RefinedSpot {
  glm::dvec3 centre{0};
  double radius = 0;  // > 0
};
inline constexpr uint8_t kSpotLift = 12;  // levels, at the centre; falls to 0 at the radius

// By vertex slot, 0 .. kSpotLift; only for slots that cover a pixel, 0 for the others. `pixels` and
// `positions` by slot. Empty when nothing is lifted. `lift` is reused storage.
void liftOf(std::span<const GridPosition> positions, std::span<const uint32_t> pixels,
            const Quantization& quantization, const glm::dmat4& worldFromMesh, const Camera& camera,
            const Foveation& foveation, const std::optional<RefinedSpot>& spot,
            std::vector<uint8_t>& lift);

}  // namespace meshfront
