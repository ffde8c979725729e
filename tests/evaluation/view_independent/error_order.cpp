#include "tests/evaluation/view_independent/error_order.h"

#include <algorithm>
#include <numeric>

namespace meshfront::evaluation {

std::vector<double> raisedErrors(std::span<const PackRecord> records,
                                 std::span<const double> errors) {
  std::vector<double> raised(errors.begin(), errors.end());
  for (size_t i = records.size(); i-- > 0;) {
    const RecordIndex parent = records[i].parent;
    if (parent != kNoRecord) raised[parent] = std::max(raised[parent], raised[i]);
  }
  return raised;
}

std::vector<RecordIndex> errorOrder(std::span<const PackRecord> records,
                                    std::span<const double> errors) {
  const std::vector<double> raised = raisedErrors(records, errors);
  std::vector<RecordIndex> order(records.size());
  std::iota(order.begin(), order.end(), RecordIndex{0});
  std::stable_sort(order.begin(), order.end(),
                   [&raised](RecordIndex a, RecordIndex b) { return raised[a] > raised[b]; });
  return order;
}

}  // namespace meshfront::evaluation
