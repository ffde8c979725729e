// The order in which a view-independent stream sends all splits: the largest error first, and no
// node before its parent. A node's own error may be below that of a node under it; it is then taken
// to be as large, because the other one waits for it.
#pragma once

#include <span>
#include <vector>

#include "tests/evaluation/view_independent/pack_records.h"

namespace meshfront::evaluation {

// `errors`: one a record. Ties in preorder. A permutation of all records in which every one can be
// applied when its turn comes.
[[nodiscard]] std::vector<RecordIndex> errorOrder(std::span<const PackRecord> records,
                                                  std::span<const double> errors);

// What a node waits for counts: each error at least as large as the largest one below it.
[[nodiscard]] std::vector<double> raisedErrors(std::span<const PackRecord> records,
                                               std::span<const double> errors);

}  // namespace meshfront::evaluation
