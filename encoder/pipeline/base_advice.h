// Why a base mesh stayed large, and what to do about it, in words.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "encoder/simplification/simplify.h"

namespace meshfront {

// A base mesh above this share of the vertices is worth a word: receivers load it whole before they
// see anything.
inline constexpr double kLargeBase = 0.02;

// One sentence or two each; empty if the base is as small as asked for and not large. `vertexCount`
// is that of the whole mesh.
[[nodiscard]] std::vector<std::string> adviceOnBase(const SimplifyReport& report,
                                                    uint64_t vertexCount);

}  // namespace meshfront
