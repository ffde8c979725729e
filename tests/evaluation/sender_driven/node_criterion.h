// The criteria of a node as they go to a client that coarsens by them: logarithms of error and
// radius in quarters of an octave, the cone's sine in 32nds, its axis on an octahedron of 63 x 63.
// Each is coded as the difference from the parent's, which the client has.
#pragma once

#include <array>
#include <cstdint>

#include "shared/bits/bit_reader.h"
#include "shared/bits/bit_writer.h"
#include "tests/evaluation/sender_driven/sender_model.h"

namespace meshfront::evaluation {

struct NodeCriterion {
  uint8_t error = 0;   // 0: none; else 4 log2(grid steps) + 64, rounded up
  uint8_t radius = 0;  // likewise
  uint8_t sine = 32;   // 32: no cone
  std::array<int8_t, 2> axis{};

  [[nodiscard]] static NodeCriterion of(const ViewCriteria& criteria);
  // `parent`: of a root the default.
  void write(BitWriter& out, const NodeCriterion& parent) const;
  [[nodiscard]] static NodeCriterion read(BitReader& in, const NodeCriterion& parent);

  friend bool operator==(const NodeCriterion&, const NodeCriterion&) = default;
};

}  // namespace meshfront::evaluation
