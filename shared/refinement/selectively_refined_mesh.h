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
//    pair of neighbouring slots. Free slots and faces at virtual vertices are {0, 0, 0} in
//    drawnCorners().
// Single-threaded; owned by one thread at a time.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/bits/bit_store.h"
#include "shared/codec/base_mesh.h"
#include "shared/codec/position_prediction.h"
#include "shared/codec/record.h"
#include "shared/codec/ring_cut.h"
#include "shared/hierarchy/node_id.h"
#include "shared/mesh/grid_mesh.h"
#include "shared/refinement/half_edge_mesh.h"
#include "shared/result.h"

namespace meshfront {

using NodeIndex = uint32_t;   // a node met so far; stable for the mesh's lifetime
using VertexSlot = uint32_t;  // a front vertex's place
inline constexpr uint32_t kNone = UINT32_MAX;

class SelectivelyRefinedMesh {
 public:
  [[nodiscard]] static Result<SelectivelyRefinedMesh> fromBase(BaseMesh base);

  // --- the front -------------------------------------------------------------------------------
  // Slots in use or free: size of positions().
  [[nodiscard]] size_t vertexSlotCount() const { return positions_.size(); }
  // The front node in a slot; kNone for a free slot. Virtual vertices are nodes too.
  [[nodiscard]] NodeIndex nodeAt(VertexSlot slot) const { return nodeAt_[slot]; }
  [[nodiscard]] std::optional<NodeIndex> find(const NodeId& id) const;  // any node met so far
  [[nodiscard]] size_t nodeCount() const { return nodes_.size(); }      // nodes met so far
  [[nodiscard]] NodeId id(NodeIndex node) const { return ids_[node]; }
  [[nodiscard]] bool isActive(NodeIndex node) const;
  [[nodiscard]] bool isLeaf(NodeIndex node) const { return nodes_[node].isLeaf; }
  [[nodiscard]] bool isVirtual(NodeIndex node) const { return isVirtualSlot(node); }
  // Significance level; of no meaning for a leaf.
  [[nodiscard]] unsigned level(NodeIndex node) const { return nodes_[node].level; }
  [[nodiscard]] VertexSlot slot(NodeIndex node) const { return nodes_[node].slot; }  // if active
  // Was split before: resplit() works.
  [[nodiscard]] bool hasRecord(NodeIndex node) const { return nodes_[node].hasRecord; }
  [[nodiscard]] NodeIndex parent(NodeIndex node) const { return nodes_[node].parent; }  // or kNone
  // Children of a node that has been split once, the right one behind the left one; else kNone.
  [[nodiscard]] NodeIndex leftChild(NodeIndex node) const { return nodes_[node].leftChild; }

  [[nodiscard]] uint64_t splitsApplied() const { return splitsApplied_; }  // in the front now
  [[nodiscard]] uint64_t recordsHeld() const { return recordsHeld_; }      // distinct ones
  [[nodiscard]] uint64_t splitCount() const { return base_.splitCount; }   // of the full mesh
  [[nodiscard]] bool complete() const { return splitsApplied() == splitCount(); }
  [[nodiscard]] uint64_t drawnTriangleCount() const { return drawnCount_; }
  [[nodiscard]] const BaseMesh& base() const { return base_; }

  // --- for tools that show how records apply ---------------------------------------------------
  [[nodiscard]] const HalfEdgeMesh& edges() const { return edges_; }  // vertices are slots
  [[nodiscard]] FaceKey keyOf(FaceSlot face) const;                   // of a face that is in use
  [[nodiscard]] GridPosition position(NodeIndex node) const { return nodes_[node].position; }
  [[nodiscard]] PredictedNormal normal(NodeIndex node) const { return nodes_[node].normal; }

  // --- changing it -----------------------------------------------------------------------------
  // Untrusted record bits: [bitOffset, bitOffset + bitLength) of `bytes`. The node must be active
  // and no leaf. On an error the mesh is unchanged. The bits are copied and kept.
  Result<void> split(NodeIndex node, std::span<const uint8_t> bytes, uint64_t bitOffset,
                     uint32_t bitLength);
  [[nodiscard]] bool canCollapse(NodeIndex node) const;  // both children are active
  void collapse(NodeIndex node);                         // requires canCollapse()
  Result<void> resplit(NodeIndex node);                  // requires hasRecord() and isActive()

  // --- drawing ---------------------------------------------------------------------------------
  // By vertex slot; of no meaning for free slots and virtual vertices.
  [[nodiscard]] std::span<const GridPosition> positions() const { return positions_; }
  // By face slot, corners by vertex slot; {0, 0, 0} for what is not drawn.
  [[nodiscard]] std::span<const Triangle> drawnCorners() const { return drawn_; }
  // Grows with every change; a viewer compares it with the last one it uploaded.
  [[nodiscard]] uint64_t changeCount() const { return changes_; }

  // What vertices carry, and by vertex slot how much; empty if they carry nothing.
  [[nodiscard]] const AttributeLayout& attributeLayout() const {
    return base_.tables.attributes.layout;
  }
  [[nodiscard]] std::span<const VertexAttributes> attributes() const { return attributes_; }
  // The same if there are colours among it, else empty.
  [[nodiscard]] std::span<const VertexAttributes> coloured() const {
    return attributeLayout().colours ? attributes() : std::span<const VertexAttributes>();
  }

  // The drawn triangles as a plain mesh: used vertices only, in slot order.
  [[nodiscard]] GridMesh snapshot() const;

 private:
  struct Node {
    NodeIndex parent = kNone;
    NodeIndex leftChild = kNone;
    VertexSlot slot = kNone;
    FaceSlot faces = 0;         // of a split node: its pair
    uint64_t recordOffset = 0;  // in records_
    uint32_t recordLength = 0;
    bool hasRecord = false;
    PredictedNormal normal{0, 0, kNormalLength};
    GridPosition position{};
    uint8_t level = 0;
    bool isLeaf = false;
  };

  Result<void> apply(NodeIndex node, std::span<const uint8_t> bytes, uint64_t bitOffset,
                     uint32_t bitLength);
  [[nodiscard]] bool isVirtualSlot(uint32_t slot) const {
    return slot >= firstVirtual_ && slot < endVirtual_;
  }
  [[nodiscard]] uint64_t isDrawn(FaceSlot face) const { return drawn_[face] != Triangle{} ? 1 : 0; }
  void updateDrawn(FaceSlot face);

  BaseMesh base_;
  uint32_t firstVirtual_ = 0;  // virtual vertices keep their slots, which equal their nodes
  uint32_t endVirtual_ = 0;
  std::vector<Node> nodes_;
  std::vector<NodeId> ids_;  // by node
  // By node: the parent of the last right child on the way to it; kNone if there is none.
  std::vector<NodeIndex> aboveTurn_;
  std::vector<NodeIndex> nodeAt_;  // by vertex slot
  std::vector<GridPosition> positions_;
  std::vector<VertexAttributes> attributes_;      // by vertex slot, where there are any
  std::vector<VertexAttributes> nodeAttributes_;  // by node, likewise
  HalfEdgeMesh edges_;
  std::vector<NodeIndex> creators_;  // by pair of face slots
  std::vector<Triangle> drawn_;      // by face slot
  BitStore records_;
  uint64_t drawnCount_ = 0;
  uint64_t splitsApplied_ = 0;
  uint64_t recordsHeld_ = 0;
  uint64_t changes_ = 0;
  // Working space of apply().
  std::vector<HalfEdge> ring_;
  std::vector<NodeId> entries_;
  RingWalkSpace space_;
};

}  // namespace meshfront
