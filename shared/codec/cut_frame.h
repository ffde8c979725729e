// How a ring's nodes lie around a split, as contexts for the cut code: the two cut neighbours l and
// r are likely those that make good triangles with the edge from s to t. Everything here is known
// to every receiver at every front; integers only.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <optional>

#include "shared/codec/position_prediction.h"
#include "shared/mesh/quantization.h"

namespace meshfront {

inline constexpr unsigned kPairPlaces = 16;
inline constexpr unsigned kStepPlaces = 256 + 3;

// The tangent plane at s: x along d = t - s, y to the left of it, both times |d|, in 64ths of
// a grid step.
class CutFrame {
 public:
  // A node's place in the plane; virtual vertices have none.
  struct Place {
    int64_t x = 0;
    int64_t y = 0;
    bool known = false;
  };

  CutFrame(const GridPosition& s, const GridPosition& delta, const PredictedNormal& normal)
      : s_(s),
        along_{delta[0], delta[1], delta[2]},
        aside_{int64_t{normal[1]} * delta[2] - int64_t{normal[2]} * delta[1],
               int64_t{normal[2]} * delta[0] - int64_t{normal[0]} * delta[2],
               int64_t{normal[0]} * delta[1] - int64_t{normal[1]} * delta[0]},
        square_((along_[0] * along_[0] + along_[1] * along_[1] + along_[2] * along_[2])
                << kFractionBits) {}

  // Of an optional or a pointer; without value for a virtual vertex.
  template <typename OptionalPosition>
  [[nodiscard]] Place place(const OptionalPosition& position) const {
    return position ? place(*position) : Place{};
  }
  [[nodiscard]] Place place(const GridPosition& position) const {
    Place out{0, 0, true};
    for (size_t i = 0; i < 3; ++i) {
      const int64_t q = position[i] - s_[i];
      out.x += q * along_[i];
      out.y += q * aside_[i];
    }
    out.x *= int64_t{1} << kFractionBits;
    out.y >>= 14 - kFractionBits;  // normals are 2^14 long
    return out;
  }

  // 0 .. kPairPlaces - 1: on which sides of d, and of its middle, two nodes lie.
  [[nodiscard]] unsigned pairPlaces(const Place& first, const Place& second) const {
    return (2 * first.x > square_ ? 8U : 0U) | (2 * second.x > square_ ? 4U : 0U) |
           (first.y > 0 ? 2U : 0U) | (second.y > 0 ? 1U : 0U);
  }
  // 0 .. kStepPlaces - 1: of two neighbours in the ring, the one nearer to t's side first, which
  // closes the better triangle? By Delaunay's criterion for the diagonals of (s, t, near, far).
  // `right`: on the side of r.
  [[nodiscard]] unsigned stepPlaces(Place near, Place far, bool right) const;

 private:
  static constexpr unsigned kFractionBits = 6;  // so that the shortest d has angles too
  static constexpr unsigned kPlaceBits = 13;    // of a coordinate while angles are compared

  // How far the sum of two opposite angles of a quadrilateral is from 180 degrees, in 8 steps each
  // way: 0 .. 7 above, 8 .. 15 below, from its sine and cosine (of any common scale).
  [[nodiscard]] static unsigned angleStep(int64_t sine, int64_t cosine) {
    // Tangents below 1/8, 1/4, 1/2, 3/4, 5/4, 2 and 4; sine and cosine are below 2^57.
    const int64_t rise = std::llabs(sine);
    const int64_t run = -cosine;
    // Each of these holds where the ones before it do; summed up, so that nothing is guessed.
    const unsigned below = (8 * rise < run ? 1U : 0U) + (4 * rise < run ? 1U : 0U) +
                           (2 * rise < run ? 1U : 0U) + (4 * rise < 3 * run ? 1U : 0U) +
                           (4 * rise < 5 * run ? 1U : 0U) + (rise < 2 * run ? 1U : 0U) +
                           (rise < 4 * run ? 1U : 0U);
    const unsigned step = 7 - below;
    return sine > 0 ? 8 + step : 7 - step;
  }

  GridPosition s_;
  std::array<int64_t, 3> along_;  // d
  std::array<int64_t, 3> aside_;  // n x d
  int64_t square_;                // d·d
};

inline unsigned CutFrame::stepPlaces(Place near, Place far, bool right) const {
  if (!near.known || !far.known) return 256 + (near.known ? 1U : 0U) + (far.known ? 2U : 0U);
  if (right) {
    near.y = -near.y;
    far.y = -far.y;
  }
  const unsigned sides = (near.y > 0 ? 2U : 0U) | (far.y > 0 ? 1U : 0U);
  const int64_t middle = near.x + far.x - square_;
  const unsigned ahead =
      (middle < -square_ ? 0U : 1U) + (middle < 0 ? 0U : 1U) + (middle < square_ ? 0U : 1U);

  const uint64_t largest =
      static_cast<uint64_t>(std::llabs(near.x)) | static_cast<uint64_t>(std::llabs(near.y)) |
      static_cast<uint64_t>(std::llabs(far.x)) | static_cast<uint64_t>(std::llabs(far.y)) |
      static_cast<uint64_t>(square_);
  const auto width = static_cast<unsigned>(std::bit_width(largest));
  const unsigned shift = width > kPlaceBits ? width - kPlaceBits : 0;
  const int64_t s = square_ >> shift;
  const int64_t nx = near.x >> shift;
  const int64_t ny = near.y >> shift;
  const int64_t fx = far.x >> shift;
  const int64_t fy = far.y >> shift;
  // The angles at t, between s and near, and at far, between s and near.
  const int64_t cosT = -s * (nx - s);
  const int64_t sinT = std::llabs(s * ny);
  const int64_t cosFar = -fx * (nx - fx) - fy * (ny - fy);
  const int64_t sinFar = std::llabs(fx * (ny - fy) - fy * (nx - fx));
  const unsigned angle = angleStep(sinT * cosFar + cosT * sinFar, cosT * cosFar - sinT * sinFar);
  return (sides * 4 + ahead) * 16 + angle;
}

}  // namespace meshfront
