// A pack decoded the way a receiver decodes it: requests as bitstrings, answers parsed, records
// applied to a selectively refined mesh.
#pragma once

#include <span>
#include <vector>

#include "shared/refinement/selectively_refined_mesh.h"
#include "shared/result.h"
#include "shared/store/pack_store.h"

namespace meshfront {

// What a PackStore of a program that touches every chunk may take for its index.
inline constexpr size_t kIndexBudget = size_t{4} << 30;

[[nodiscard]] Result<SelectivelyRefinedMesh> baseOf(RecordStore& store);

// Asks for the records of front nodes (any order; encoded and decoded as a request) and applies
// them. Gives the request's length in bits.
[[nodiscard]] Result<uint64_t> refine(RecordStore& store, SelectivelyRefinedMesh& mesh,
                                      std::span<const NodeIndex> nodes);

// Everything.
[[nodiscard]] Result<SelectivelyRefinedMesh> fullMesh(RecordStore& store);

}  // namespace meshfront
