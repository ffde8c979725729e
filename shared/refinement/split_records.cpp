#include "shared/refinement/split_records.h"

#include <array>

namespace meshfront {
namespace {

// How many entries ahead of the one that is split each thing is fetched.
constexpr size_t kNodeAhead = 12;
constexpr size_t kSlotAhead = 9;
constexpr size_t kFaceAhead = 6;
constexpr size_t kRingAhead = 3;
constexpr size_t kRemembered = 16;  // a power of two beyond kNodeAhead

}  // namespace

Result<void> splitRecords(SelectivelyRefinedMesh& mesh, std::span<const RecordEntry> entries,
                          std::span<const uint8_t> bytes) {
  using Fetch = SelectivelyRefinedMesh::Fetch;
  // Nodes of entries, by number: kNone where they were not known yet when they were looked up.
  std::array<NodeIndex, kRemembered> nodes{};
  const auto nodeOf = [&](size_t i) -> NodeIndex& { return nodes[i % kRemembered]; };
  const auto fetch = [&](size_t i, Fetch stage) {
    if (i < entries.size() && nodeOf(i) != kNone) mesh.prefetch(nodeOf(i), stage);
  };
  const auto lookUp = [&](size_t i) {
    if (i < entries.size()) nodeOf(i) = mesh.find(entries[i].id).value_or(kNone);
  };
  for (size_t i = 0; i < kNodeAhead; ++i) lookUp(i);
  for (size_t i = 0; i < entries.size(); ++i) {
    lookUp(i + kNodeAhead);
    fetch(i + kNodeAhead, Fetch::node);
    fetch(i + kSlotAhead, Fetch::slot);
    fetch(i + kFaceAhead, Fetch::firstFace);
    fetch(i + kRingAhead, Fetch::ring);
    const RecordEntry& entry = entries[i];
    if (nodeOf(i) == kNone) nodeOf(i) = mesh.find(entry.id).value_or(kNone);
    if (nodeOf(i) == kNone) return fail("split: the node is not known");
    if (auto done = mesh.split(nodeOf(i), bytes, entry.bitOffset, entry.bitLength); !done)
      return done;
  }
  return {};
}

}  // namespace meshfront
