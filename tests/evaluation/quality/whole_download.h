// What a user would take otherwise: the whole mesh as one compressed file, of which nothing can be
// seen before all of it is there.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "shared/result.h"
#include "tests/evaluation/view_independent/pack_records.h"

namespace meshfront::evaluation {

// Octets of Draco's file of the full mesh at the pack's quantisation (draco_encoder -qp BITS -cl
// 10), positions and connectivity alone. The vertices are written as grid points, so that Draco's
// grid is the pack's and nothing more is lost. nullopt where draco_encoder is not installed.
[[nodiscard]] Result<std::optional<uint64_t>> dracoBytes(const RefinedPack& full);

}  // namespace meshfront::evaluation
