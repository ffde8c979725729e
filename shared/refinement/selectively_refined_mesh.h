// The mesh at a front of the vertex hierarchy: split any front vertex by its record, in any order;
// collapse back what is no longer needed and split it again from the record kept (Kim and Lee 2001,
// truly selective refinement). At a front the mesh is the same whatever the order was.
//
//   auto mesh = SelectivelyRefinedMesh::fromBase(base);
//   mesh->split(node, bytes, bitOffset, bitLength);   // a record as it came over the wire
//   draw(mesh->positions(), mesh->corners());
//
// Storage is by slots, fit for GPU buffers:
//  - a *vertex slot* holds an active front vertex. Splitting s keeps its slot for the left child u
//    (half-edge collapse: u stands where s stood) and takes another one for the right child t.
//  - a *face slot* holds a triangle: three corners by vertex slot. The two faces of a split take a
//    pair of neighbouring slots. Free slots and faces at virtual vertices have all corners equal to
//    zero in drawnCorners().
// Single-threaded; owned by one thread at a time.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/codec/base_mesh.h"
#include "shared/codec/record.h"
#include "shared/hierarchy/node_id.h"
#include "shared/result.h"

namespace meshfront {

using NodeIndex = uint32_t;   // a node met so far; stable for the mesh's lifetime
using VertexSlot = uint32_t;  // a front vertex's place
using FaceSlot = uint32_t;
inline constexpr uint32_t kNone = UINT32_MAX;

class SelectivelyRefinedMesh {
 public:
  [[nodiscard]] static Result<SelectivelyRefinedMesh> fromBase(BaseMesh base);

  // --- the front -------------------------------------------------------------------------------
  [[nodiscard]] size_t vertexSlotCount() const;  // slots in use or free: size of positions()
  // The front node in a slot; kNone for a free slot. Virtual vertices are nodes too.
  [[nodiscard]] NodeIndex nodeAt(VertexSlot slot) const;
  [[nodiscard]] std::optional<NodeIndex> find(const NodeId& id) const;  // any node met so far
  [[nodiscard]] NodeId id(NodeIndex node) const;
  [[nodiscard]] bool isActive(NodeIndex node) const;
  [[nodiscard]] bool isLeaf(NodeIndex node) const;
  [[nodiscard]] bool isVirtual(NodeIndex node) const;
  [[nodiscard]] unsigned level(NodeIndex node) const;    // of no meaning for a leaf
  [[nodiscard]] VertexSlot slot(NodeIndex node) const;   // of an active node
  [[nodiscard]] bool hasRecord(NodeIndex node) const;    // was split before: resplit() works
  [[nodiscard]] NodeIndex parent(NodeIndex node) const;  // kNone for a root
  // Children of a node that has been split once; {left, right}.
  [[nodiscard]] std::pair<NodeIndex, NodeIndex> children(NodeIndex node) const;

  [[nodiscard]] uint64_t splitsApplied() const;  // splits in the front now
  [[nodiscard]] uint64_t recordsHeld() const;    // distinct records received
  [[nodiscard]] uint64_t splitCount() const;     // of the full mesh
  [[nodiscard]] bool complete() const { return splitsApplied() == splitCount(); }
  [[nodiscard]] uint64_t drawnTriangleCount() const;
  [[nodiscard]] const BaseMesh& base() const;

  // --- changing it -----------------------------------------------------------------------------
  // Untrusted record bits: [bitOffset, bitOffset + bitLength) of `bytes`. The node must be active
  // and no leaf. On an error the mesh is unchanged. The bits are copied and kept.
  Result<void> split(NodeIndex node, std::span<const uint8_t> bytes, uint64_t bitOffset,
                     uint32_t bitLength);
  [[nodiscard]] bool canCollapse(NodeIndex node) const;  // both children are active
  void collapse(NodeIndex node);                         // requires canCollapse()
  Result<void> resplit(NodeIndex node);                  // requires hasRecord() and isActive()

  // --- drawing ---------------------------------------------------------------------------------
  [[nodiscard]] std::span<const GridPosition> positions() const;  // by vertex slot
  // By face slot, corners by vertex slot; {0,0,0} for what is not drawn.
  [[nodiscard]] std::span<const Triangle> drawnCorners() const;
  // Grows with every change to a slot's content; a viewer compares it with the last it uploaded.
  [[nodiscard]] uint64_t changeCount() const;

  // The drawn triangles as a plain mesh: used vertices only, in slot order.
  struct Snapshot {
    std::vector<GridPosition> positions;
    std::vector<Triangle> triangles;
  };
  [[nodiscard]] Snapshot snapshot() const;
};

}  // namespace meshfront
