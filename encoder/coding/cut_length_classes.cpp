#include "encoder/coding/cut_length_classes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meshfront {

std::vector<uint16_t> chooseCutLengths(std::span<const uint64_t> histogram, size_t maxClasses) {
  std::vector<uint16_t> lengths;
  std::vector<double> counts;
  double total = 0;
  for (size_t n = 0; n < histogram.size(); ++n) {
    if (histogram[n] == 0) continue;
    lengths.push_back(static_cast<uint16_t>(std::max<size_t>(n, 1)));
    counts.push_back(static_cast<double>(histogram[n]));
    total += counts.back();
  }
  if (lengths.empty()) return {};
  if (lengths.size() > 1 && lengths[0] == lengths[1]) {  // 0 and 1 bit are one class
    counts[1] += counts[0];
    lengths.erase(lengths.begin());
    counts.erase(counts.begin());
  }
  const size_t n = lengths.size();
  constexpr double kNever = std::numeric_limits<double>::infinity();
  // cost[k][j]: the least bits for the lengths before j in k classes; from[k][j]: the last class's
  // begin.
  const size_t most = std::min(maxClasses, n);
  std::vector<std::vector<double>> cost(most + 1, std::vector<double>(n + 1, kNever));
  std::vector<std::vector<size_t>> from(most + 1, std::vector<size_t>(n + 1, 0));
  cost[0][0] = 0;
  for (size_t k = 1; k <= most; ++k) {
    for (size_t j = k; j <= n; ++j) {
      double members = 0;
      double padding = 0;
      for (size_t i = j; i-- > 0;) {
        members += counts[i];
        padding += counts[i] * (lengths[j - 1] - lengths[i]);
        const double bits = cost[k - 1][i] + padding + members * std::log2(total / members);
        if (bits < cost[k][j]) {
          cost[k][j] = bits;
          from[k][j] = i;
        }
      }
    }
  }
  size_t best = 1;
  for (size_t k = 2; k <= most; ++k)
    if (cost[k][n] < cost[best][n] - 1e-9) best = k;
  std::vector<uint16_t> chosen;
  for (size_t k = best, j = n; k > 0; j = from[k][j], --k) chosen.push_back(lengths[j - 1]);
  std::reverse(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace meshfront
