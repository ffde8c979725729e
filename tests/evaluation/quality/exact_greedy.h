// The order by true image error: of all splits that can be made, always the one whose picture is
// nearest to the full mesh's. Each is tried, drawn and taken back. Tells how much is left to gain
// for rankings that must guess; takes thousands of pictures, so for small meshes.
//
// After a split the ones around it are tried anew at once, those one ring further on when they come
// first. A vertex is worth the best of what its own split gains and of what it gains for each
// record together with its children's: a first step may make the picture worse.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tests/evaluation/quality/easel.h"
#include "tests/evaluation/quality/quality_curve.h"
#include "tests/evaluation/view_independent/pack_records.h"

namespace meshfront::evaluation {

struct GreedyOrder {
  std::vector<RecordIndex> order;
  QualityCurve curve;     // a point a record; bytes are records
  uint64_t pictures = 0;  // drawn for it
};

// Ends at `stopAt` dB, or when none of `allowed` (by record; closed under parents) is left.
[[nodiscard]] Result<GreedyOrder> exactGreedyOrder(const PackRecords& pack,
                                                   std::span<const uint8_t> allowed, Easel& easel,
                                                   const EvaluationView& view,
                                                   const Picture& reference, double stopAt,
                                                   bool lookAhead);

}  // namespace meshfront::evaluation
