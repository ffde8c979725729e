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

}  // namespace meshfront
