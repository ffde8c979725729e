#include "encoder/coding/cut_length_classes.h"

#include <algorithm>
#include <limits>

#include "shared/bits/fixed_logarithm.h"

namespace meshfront {

std::vector<uint16_t> chooseCutLengths(std::span<const uint64_t> histogram, size_t maxClasses) {
  std::vector<uint16_t> lengths;
  std::vector<uint64_t> counts;
  uint64_t total = 0;
  for (size_t n = 0; n < histogram.size(); ++n) {
    if (histogram[n] == 0) continue;
    lengths.push_back(static_cast<uint16_t>(std::max<size_t>(n, 1)));
    counts.push_back(histogram[n]);
    total += counts.back();
  }
  if (lengths.empty()) return {};
  if (lengths.size() > 1 && lengths[0] == lengths[1]) {  // 0 and 1 bit are one class
    counts[1] += counts[0];
    lengths.erase(lengths.begin());
    counts.erase(counts.begin());
  }
  const size_t n = lengths.size();
  constexpr uint64_t kNever = std::numeric_limits<uint64_t>::max();
  // cost[k][j]: the least for the lengths before j in k classes, in 65536ths of a bit; from[k][j]:
  // the last class's begin.
  const size_t most = std::min(maxClasses, n);
  std::vector<std::vector<uint64_t>> cost(most + 1, std::vector<uint64_t>(n + 1, kNever));
  std::vector<std::vector<size_t>> from(most + 1, std::vector<size_t>(n + 1, 0));
  cost[0][0] = 0;
  for (size_t k = 1; k <= most; ++k) {
    for (size_t j = k; j <= n; ++j) {
      uint64_t members = 0;
      uint64_t padding = 0;
      for (size_t i = j; i-- > 0;) {
        members += counts[i];
        padding += counts[i] * (lengths[j - 1] - lengths[i]);
        if (cost[k - 1][i] == kNever) continue;
        const uint64_t bits = cost[k - 1][i] + (padding << kFixedBits) +
                              members * (fixedLog2(total) - fixedLog2(members));
        if (bits < cost[k][j]) {
          cost[k][j] = bits;
          from[k][j] = i;
        }
      }
    }
  }
  size_t best = 1;
  for (size_t k = 2; k <= most; ++k)
    if (cost[k][n] < cost[best][n]) best = k;
  std::vector<uint16_t> chosen;
  for (size_t k = best, j = n; k > 0; j = from[k][j], --k) chosen.push_back(lengths[j - 1]);
  std::reverse(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace meshfront
