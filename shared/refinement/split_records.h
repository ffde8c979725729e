// Splits the nodes of an answer or chunk, in its order. Faster than one by one: what later splits
// read is fetched into the caches meanwhile, which takes most of the time where they lie all over
// the mesh.
#pragma once

#include <cstdint>
#include <span>

#include "shared/codec/chunk.h"
#include "shared/refinement/selectively_refined_mesh.h"

namespace meshfront {

// `bytes`: what the entries' offsets are into. Stops at the first record that does not apply, with
// those in front of it applied. A node that is not active or not known is an error too.
Result<void> splitRecords(SelectivelyRefinedMesh& mesh, std::span<const RecordEntry> entries,
                          std::span<const uint8_t> bytes);

}  // namespace meshfront
