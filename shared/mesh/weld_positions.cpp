#include "shared/mesh/weld_positions.h"

#include <bit>
#include <random>

namespace meshfront {
namespace {

constexpr uint32_t kEmpty = UINT32_MAX;

uint64_t mix(uint64_t h, double coordinate) {
  // Adding zero turns -0 into 0, so that equal coordinates have equal bits.
  h = (h ^ std::bit_cast<uint64_t>(coordinate + 0.0)) * 0x9e3779b97f4a7c15U;
  h ^= h >> 32;
  h *= 0xd6e8feb86659fd93U;
  return h ^ (h >> 29);
}

}  // namespace

WeldedPositions weldPositions(std::span<const std::array<double, 3>> positions) {
  // A seed of its own for each process: no file can be made to collide on purpose.
  static const uint64_t seed = uint64_t{std::random_device{}()} << 32 | std::random_device{}();
  const size_t slots = std::bit_ceil(positions.size() * 2 + 1);
  std::vector<uint32_t> table(slots, kEmpty);
  WeldedPositions welded;
  welded.indexOf.reserve(positions.size());
  welded.positions.reserve(positions.size());
  for (const auto& p : positions) {
    size_t slot = mix(mix(mix(seed, p[0]), p[1]), p[2]) & (slots - 1);
    while (table[slot] != kEmpty && welded.positions[table[slot]] != p)
      slot = (slot + 1) & (slots - 1);
    if (table[slot] == kEmpty) {
      table[slot] = static_cast<uint32_t>(welded.positions.size());
      welded.positions.push_back(p);
    }
    welded.indexOf.push_back(table[slot]);
  }
  return welded;
}

}  // namespace meshfront
