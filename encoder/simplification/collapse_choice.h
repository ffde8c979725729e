// Where a vertex goes if it is removed: the cheapest neighbour that the rules allow.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

#include "encoder/simplification/closed_mesh.h"
#include "encoder/simplification/collapse_queue.h"
#include "encoder/simplification/simplify.h"
#include "encoder/simplification/vertex_quadric.h"

namespace meshfront {

// A vertex with more neighbours than this is not removed: moving it would look at all of them.
inline constexpr uint32_t kMaxRemovedValence = 64;

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

// Costs as integers in the order of collapsing: those that turn a face over come last.
inline constexpr uint32_t kFlipBit = 0x80000000U;
inline uint32_t gKeyMask = getenv("KB") ? ~((1u<<(23-atoi(getenv("KB"))))-1) : ~0u;
[[nodiscard]] inline uint32_t costKey(float cost) {
  constexpr float kLargest = std::numeric_limits<float>::max();
  return std::bit_cast<uint32_t>(cost > 0 ? (cost < kLargest ? cost : kLargest) : 0.0F) & gKeyMask;
}

struct CollapseChoice {
  HalfEdge halfEdge;  // invalid: none
  uint32_t key = 0;
};

class CollapseChooser {
 public:
  CollapseChooser(const ClosedMesh& mesh, const std::vector<SimplifyVertex>& vertices,
                  unsigned balance, SimplifyReport& counts)
      : mesh_(mesh), vertices_(vertices), balance_(balance), counts_(counts) {}

  // Key of the cheapest neighbour whether allowed or not: never above that of choose().
  [[nodiscard]] uint32_t lowerBound(uint32_t removed);
  void fetch(std::span<const CollapseQueue::Entry> entries) const;
  [[nodiscard]] CollapseChoice choose(uint32_t removed);
  // Cost of moving one vertex onto another, by the error alone.
  [[nodiscard]] float cost(const SimplifyVertex& removed, const SimplifyVertex& kept) const;

  // The neighbours of the vertex that choose() saw last, clockwise.
  [[nodiscard]] std::span<const uint32_t> ring() const { return {ids_.data(), size_}; }

 private:
  void loadRing(uint32_t removed);
  void findNormals(const SimplifyVertex& removed);
  [[nodiscard]] bool inRing(uint32_t vertex) const;
  [[nodiscard]] bool linkConditionHolds(uint32_t at) const;
  [[nodiscard]] bool adjacent(uint32_t a, uint32_t b) const;
  [[nodiscard]] bool turnsFaceOver(uint32_t at) const;

  const ClosedMesh& mesh_;
  const std::vector<SimplifyVertex>& vertices_;
  unsigned balance_;
  SimplifyReport& counts_;

  uint32_t size_ = 0;
  uint64_t idBits_ = 0;  // bit v % 64 for each v of the ring
  std::array<uint32_t, kMaxRemovedValence> ids_{};
  std::array<HalfEdge, kMaxRemovedValence> halfEdges_;
  std::array<const SimplifyVertex*, kMaxRemovedValence> at_{};
  std::array<float, kMaxRemovedValence> costs_{};
  std::array<Offset, kMaxRemovedValence> offsets_{};  // neighbour - removed
  std::array<Offset, kMaxRemovedValence> normals_{};  // of face (removed, i, i + 1); 0 if virtual
};

}  // namespace meshfront
