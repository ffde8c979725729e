// What a drawer must change to show a mesh as it is now: the slots that differ from those of the
// update before, and nothing else. Made where the mesh is refined, used where it is drawn, which
// may be another thread: an update holds copies.
//
// Slots are those of SelectivelyRefinedMesh. They never go away: a mesh that shrinks leaves free
// vertex slots, which no triangle names, and undrawn face slots, {0, 0, 0}.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "shared/mesh/indexed_mesh.h"
#include "shared/mesh/quantization.h"
#include "shared/mesh/vertex_normals.h"

namespace meshfront {

// A front vertex as a drawer needs it. 48 bytes, without padding: fit for a GPU buffer as it is.
struct DrawnVertex {
  GridPosition position{};
  // Where a vertex that comes of a split slides from (geomorph): the place of its parent. A left
  // child stands there itself, and what may slide is an ancestor of it that was split before it
  // was drawn: the place of the last right child's parent on the path; without one its own.
  GridPosition from{};
  PackedNormal normal{};  // the mesh's own where it carries any, else vertex_normals.h's
  std::array<uint8_t, 4> colour{0, 0, 0, 255};  // sRGB and alpha; of no meaning without colours
  uint32_t tree = 0;                            // of the hierarchy: NodeId::tree
  uint8_t level = 0;                            // significance; of no meaning for a leaf
  uint8_t isLeaf = 0;                           // 1: it is final
  uint8_t depth = 0;                            // below the root
  uint8_t unused = 0;                           // 0
  uint32_t node = 0;                            // NodeIndex in the mesh, for picking

  friend bool operator==(const DrawnVertex&, const DrawnVertex&) = default;
};
static_assert(sizeof(DrawnVertex) == 48);

struct MeshUpdate {
  uint64_t changeCount = 0;  // of the mesh that this update leads to
  size_t vertexSlots = 0;    // of the whole mesh then; never fewer than before
  size_t faceSlots = 0;
  // Ascending; vertices[i] is what now lies in slots[i].
  std::vector<uint32_t> slots;
  std::vector<DrawnVertex> vertices;
  // Ascending, part of `slots`: right children that a split has brought in since the update before.
  std::vector<uint32_t> born;
  // Ascending; corners[i], by vertex slot, is what is now drawn at faces[i].
  std::vector<uint32_t> faces;
  std::vector<Triangle> corners;

  [[nodiscard]] bool empty() const { return slots.empty() && faces.empty(); }
  [[nodiscard]] size_t byteCount() const {
    return slots.size() * (sizeof(uint32_t) + sizeof(DrawnVertex)) +
           (born.size() + faces.size()) * sizeof(uint32_t) + corners.size() * sizeof(Triangle);
  }
};

}  // namespace meshfront
