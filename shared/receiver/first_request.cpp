#include "shared/receiver/first_request.h"

namespace meshfront {

double recordsUpTo(unsigned most, unsigned level) {
  return most < level ? 1 : static_cast<double>((uint64_t{2} << (most - level)) - 1);
}

std::optional<uint8_t> firstSignificance(std::span<const uint8_t> levels, uint64_t pixels,
                                         double room, unsigned maxLevel) {
  const auto count = static_cast<double>(levels.size());
  std::optional<uint8_t> best;
  for (unsigned most = 0; most <= maxLevel; ++most) {
    double records = 0;
    for (const uint8_t level : levels) records += recordsUpTo(most, level);
    if (records > room || records + count > static_cast<double>(pixels)) break;
    if (records > count) best = static_cast<uint8_t>(most);
  }
  return best;
}

size_t nodesOneLevelFiner(std::span<const uint8_t> levels, uint8_t most, double room,
                          unsigned maxLevel) {
  if (most >= maxLevel) return 0;
  double records = 0;
  size_t nodes = 0;
  while (nodes < levels.size()) {
    records += recordsUpTo(most + 1U, levels[nodes]);
    if (records > room) break;
    ++nodes;
  }
  return nodes;
}

}  // namespace meshfront
