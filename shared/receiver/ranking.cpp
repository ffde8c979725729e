#include "shared/receiver/ranking.h"

#include <algorithm>

namespace meshfront {
namespace {

template <typename PixelsOf>
std::vector<Candidate> candidates(const SelectivelyRefinedMesh& mesh,
                                  std::span<const uint8_t> excluded, size_t slots, bool visibleOnly,
                                  bool withoutKept, PixelsOf pixelsOf) {
  std::vector<Candidate> found;
  for (size_t i = 0; i < slots; ++i) {
    const auto slot = static_cast<VertexSlot>(i);
    const uint32_t pixels = pixelsOf(i);
    if (visibleOnly && pixels == 0) continue;
    const NodeIndex node = mesh.nodeAt(slot);
    if (node == kNone || mesh.isLeaf(node) || mesh.isVirtual(node)) continue;
    if (withoutKept && mesh.hasRecord(node)) continue;
    if (node < excluded.size() && excluded[node] != 0) continue;
    found.push_back({node, slot, pixels, static_cast<uint8_t>(mesh.level(node)), mesh.id(node)});
  }
  return found;
}

}  // namespace

bool ranksBefore(RankOrder order, const Candidate& a, const Candidate& b) {
  if (order == RankOrder::significance && a.level != b.level) return a.level < b.level;
  if (a.pixels != b.pixels) return a.pixels > b.pixels;
  if (a.id != b.id) return a.id < b.id;
  return a.slot < b.slot;
}

std::vector<Candidate> visibleCandidates(const SelectivelyRefinedMesh& mesh,
                                         std::span<const uint32_t> pixels,
                                         std::span<const uint8_t> excluded,
                                         const RankingBias& bias) {
  std::vector<Candidate> found =
      candidates(mesh, excluded, std::min(pixels.size(), mesh.vertexSlotCount()), true,
                 bias.withoutKept, [pixels](size_t slot) { return pixels[slot]; });
  if (bias.lift.empty() && bias.levelsBehind == 0) return found;
  for (Candidate& candidate : found) {
    const unsigned lift = candidate.slot < bias.lift.size() ? bias.lift[candidate.slot] : 0;
    const unsigned level = candidate.level + bias.levelsBehind;
    candidate.level = static_cast<uint8_t>(std::min(level - std::min(lift, level), 255U));
  }
  return found;
}

std::vector<Candidate> allCandidates(const SelectivelyRefinedMesh& mesh,
                                     std::span<const uint8_t> excluded) {
  return candidates(mesh, excluded, mesh.vertexSlotCount(), false, false,
                    [](size_t) { return 0U; });
}

void keepFirst(std::vector<Candidate>& candidates, size_t count, RankOrder order) {
  const auto before = [order](const Candidate& a, const Candidate& b) {
    return ranksBefore(order, a, b);
  };
  if (count < candidates.size()) {
    std::nth_element(candidates.begin(), candidates.begin() + static_cast<ptrdiff_t>(count),
                     candidates.end(), before);
    candidates.resize(count);
  }
  std::sort(candidates.begin(), candidates.end(), before);
}

}  // namespace meshfront
