// Where a vertex goes if it is removed: the cheapest neighbour that the rules allow.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "encoder/simplification/collapse_queue.h"
#include "encoder/simplification/collapsible_mesh.h"
#include "encoder/simplification/simplify.h"
#include "encoder/simplification/vertex_quadric.h"

namespace meshfront {

inline constexpr size_t kFetchedTogether = 16;

// All that a collapse needs to know about a vertex, in one cache line.
struct alignas(64) SimplifyVertex {
  enum class State : uint8_t {
    waiting,    // has an entry in the queue
    parked,     // nothing to collapse onto until its ring changes
    removed,    // collapsed
    immovable,  // virtual or without triangles
  };
  Offset position{};  // exact: grid coordinates have 20 bits
  VertexQuadric quadric;
  uint32_t valence = 0;
  uint32_t key = 0;  // of its entry in the queue
  uint8_t height = 0;
  State state = State::waiting;
};

// Costs as integers in the order of collapsing: those that turn a face over come last. Costs count
// in quarters of octaves, rounded down, which does not change the quality; as equal costs go by
// vertex, the work sweeps along the space-filling order and finds more of its memory cached.
inline constexpr uint32_t kFlipBit = 0x80000000U;
[[nodiscard]] inline uint32_t costKey(float cost) {
  constexpr float kLargest = std::numeric_limits<float>::max();
  constexpr unsigned kDroppedBits = 21;  // of a mantissa of 23
  const float bounded = cost > 0 ? (cost < kLargest ? cost : kLargest) : 0.0F;
  return std::bit_cast<uint32_t>(bounded) >> kDroppedBits << kDroppedBits;
}

static_assert(sizeof(SimplifyVertex) == 64);

struct CollapseChoice {
  HalfEdge halfEdge;  // invalid: none
  uint32_t key = 0;
};

class CollapseChooser {
 public:
  CollapseChooser(const CollapsibleMesh& mesh, const std::vector<SimplifyVertex>& vertices,
                  const SimplifyOptions& options, SimplifyReport& counts)
      : mesh_(mesh),
        vertices_(vertices),
        balance_(options.balance),
        maxValence_(std::min(options.maxValence, kLargestMaxValence)),
        counts_(counts) {}

  [[nodiscard]] uint32_t maxValence() const { return maxValence_; }

  // Key of the cheapest neighbour whether allowed or not: never above that of choose().
  [[nodiscard]] uint32_t lowerBound(uint32_t removed);
  // Brings the rings of at most kFetchedTogether vertices into the cache. One ring is a chain of
  // reads that wait for each other; several chains wait together.
  void fetch(std::span<const CollapseQueue::Entry> entries) const;
  [[nodiscard]] CollapseChoice choose(uint32_t removed);
  // Cost of moving one vertex onto another, by the error alone.
  [[nodiscard]] float cost(const SimplifyVertex& removed, const SimplifyVertex& kept) const;

  // The neighbours of the vertex that choose() saw last, clockwise.
  [[nodiscard]] std::span<const uint32_t> ring() const { return {ids_.data(), size_}; }

 private:
  void loadRing(uint32_t removed);
  void findNormals();
  [[nodiscard]] bool inRing(uint32_t vertex) const;
  [[nodiscard]] bool linkConditionHolds(uint32_t at) const;
  [[nodiscard]] bool adjacent(uint32_t a, uint32_t b) const;
  [[nodiscard]] bool turnsFaceOver(uint32_t at) const;

  const CollapsibleMesh& mesh_;
  const std::vector<SimplifyVertex>& vertices_;
  unsigned balance_;
  uint32_t maxValence_;
  SimplifyReport& counts_;

  uint32_t size_ = 0;
  uint64_t idBits_ = 0;  // bit v % 64 for each v of the ring
  std::array<uint32_t, kLargestMaxValence> ids_{};
  std::array<HalfEdge, kLargestMaxValence> halfEdges_;
  std::array<const SimplifyVertex*, kLargestMaxValence> at_{};
  std::array<float, kLargestMaxValence> costs_{};
  std::array<Offset, kLargestMaxValence> offsets_{};  // neighbour - removed
  std::array<Offset, kLargestMaxValence> normals_{};  // of face (removed, i, i + 1); 0 if virtual
};

}  // namespace meshfront
