// The classes of cut regions' lengths: each class is one length, regions are padded up to it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace meshfront {

// `histogram[n]`: how many regions need n bits. Chooses at most `maxClasses` lengths, ascending,
// the last one the longest needed, so that padding and the entropy of the class are least in all
// (dynamic programming over the lengths that occur). Empty for an empty histogram.
[[nodiscard]] std::vector<uint16_t> chooseCutLengths(std::span<const uint64_t> histogram,
                                                     size_t maxClasses);

}  // namespace meshfront
