// How a ring's nodes lie around a split, as contexts for the cut code: the two cut neighbours l and
// r are likely those that make good triangles with the edge from s to t. Everything here is known
// to every receiver at every front; integers only.
#pragma once

#include <array>
#include <cstdint>
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

  CutFrame(const GridPosition& s, const GridPosition& delta, const PredictedNormal& normal);

  [[nodiscard]] Place place(const std::optional<GridPosition>& position) const;

  // 0 .. kPairPlaces - 1: on which sides of d, and of its middle, two nodes lie.
  [[nodiscard]] unsigned pairPlaces(const Place& first, const Place& second) const;
  // 0 .. kStepPlaces - 1: of two neighbours in the ring, the one nearer to t's side first, which
  // closes the better triangle? By Delaunay's criterion for the diagonals of (s, t, near, far).
  // `right`: on the side of r.
  [[nodiscard]] unsigned stepPlaces(Place near, Place far, bool right) const;

 private:
  GridPosition s_;
  std::array<int64_t, 3> along_;  // d
  std::array<int64_t, 3> aside_;  // n x d
  int64_t square_;                // d·d
};

}  // namespace meshfront
