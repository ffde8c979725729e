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
// *Nodes* are what has been met of the hierarchy: those above the front (split), on it (active) and
// below it (kept). A node above the front has its record, others may; a node with a record splits
// again without anybody being asked. What is kept below the front can be forgotten.
// Single-threaded; owned by one thread at a time.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/codec/base_mesh.h"
#include "shared/codec/position_prediction.h"
#include "shared/codec/record.h"
#include "shared/codec/ring_cut.h"
#include "shared/hierarchy/node_id.h"
#include "shared/mesh/grid_mesh.h"
#include "shared/refinement/growing_array.h"
#include "shared/refinement/half_edge_mesh.h"
#include "shared/refinement/mesh_update.h"
#include "shared/refinement/record_pool.h"
#include "shared/refinement/slot_set.h"
#include "shared/result.h"

namespace meshfront {

// A node met so far; roots by their tree. Stable until the node is forgotten (forgetBelow()), which
// only happens to nodes below the front; a later node may take the index then.
using NodeIndex = uint32_t;
using VertexSlot = uint32_t;  // a front vertex's place
inline constexpr uint32_t kNone = UINT32_MAX;

class SelectivelyRefinedMesh {
 public:
  [[nodiscard]] static Result<SelectivelyRefinedMesh> fromBase(BaseMesh base);

  // --- the front -------------------------------------------------------------------------------
  // Slots in use or free: size of positions().
  [[nodiscard]] size_t vertexSlotCount() const { return slots_.size(); }
  // The front node in a slot; kNone for a free slot. Virtual vertices are nodes too.
  [[nodiscard]] NodeIndex nodeAt(VertexSlot slot) const { return occupants_[slot].node; }
  // changeCount() when that node came to the slot, its low 32 bits.
  [[nodiscard]] uint32_t occupiedSince(VertexSlot slot) const { return occupants_[slot].since; }
  // Any node known. Quick for nodes in preorder: it starts where the last call ended.
  [[nodiscard]] std::optional<NodeIndex> find(const NodeId& id) const;
  [[nodiscard]] size_t nodeCount() const { return nodes_.size(); }  // indices, forgotten ones too
  // False for a node that was forgotten. Such an index is that of a leaf that is not active.
  [[nodiscard]] bool isKnown(NodeIndex node) const { return !nodes_[node].has(kForgotten); }
  [[nodiscard]] NodeId id(NodeIndex node) const;
  [[nodiscard]] bool isActive(NodeIndex node) const {
    return nodes_[node].slot != kNone && occupants_[nodes_[node].slot].node == node;
  }
  [[nodiscard]] bool isLeaf(NodeIndex node) const { return nodes_[node].has(kLeaf); }
  [[nodiscard]] bool isVirtual(NodeIndex node) const { return isVirtualSlot(node); }
  // Above the front.
  [[nodiscard]] bool isSplit(NodeIndex node) const {
    return nodes_[node].slot != kNone && occupants_[nodes_[node].slot].node != node;
  }
  // Significance level; of no meaning for a leaf.
  [[nodiscard]] unsigned level(NodeIndex node) const { return nodes_[node].level; }
  [[nodiscard]] VertexSlot slot(NodeIndex node) const { return nodes_[node].slot; }  // if active
  // resplit() works: it was split before, or keepRecord() was called.
  [[nodiscard]] bool hasRecord(NodeIndex node) const { return nodes_[node].recordBits != 0; }
  [[nodiscard]] NodeIndex parent(NodeIndex node) const { return nodes_[node].parent; }  // or kNone
  // Children of a node that has been split once and whose children have not been forgotten, the
  // right one behind the left one; else kNone.
  [[nodiscard]] NodeIndex leftChild(NodeIndex node) const { return nodes_[node].leftChild; }

  [[nodiscard]] uint64_t splitsApplied() const { return splitsApplied_; }  // in the front now
  [[nodiscard]] uint64_t recordsHeld() const { return recordsHeld_; }      // and not forgotten
  [[nodiscard]] uint64_t splitCount() const { return base_.splitCount; }   // of the full mesh
  [[nodiscard]] bool complete() const { return splitsApplied() == splitCount(); }
  [[nodiscard]] uint64_t drawnTriangleCount() const { return drawnCount_; }
  [[nodiscard]] const BaseMesh& base() const { return base_; }

  // --- for tools that show how records apply ---------------------------------------------------
  [[nodiscard]] const HalfEdgeMesh& edges() const { return edges_; }  // vertices are slots
  [[nodiscard]] FaceKey keyOf(FaceSlot face) const {                  // of a face that is in use
    return face < edges_.baseFaces() ? FaceKey::ofBase(face)
                                     : FaceKey::of(edges_.creator(face), (face & 1) != 0);
  }
  // On the front or above it.
  [[nodiscard]] GridPosition position(NodeIndex node) const {
    return slots_[nodes_[node].slot].position;
  }
  [[nodiscard]] PredictedNormal normal(NodeIndex node) const { return nodes_[node].normal; }

  // --- changing it -----------------------------------------------------------------------------
  // Untrusted record bits: [bitOffset, bitOffset + bitLength) of `bytes`. The node must be active
  // and no leaf. On an error the mesh is unchanged. The bits are copied and kept.
  Result<void> split(NodeIndex node, std::span<const uint8_t> bytes, uint64_t bitOffset,
                     uint32_t bitLength);
  [[nodiscard]] bool canCollapse(NodeIndex node) const {  // both children are active
    const NodeIndex left = nodes_[node].leftChild;
    return left != kNone && isActive(left) && isActive(left + 1);
  }
  void collapse(NodeIndex node);  // requires canCollapse()
  // Requires hasRecord() and isActive(). On an error, which only a record from keepRecord() can
  // lead to, the mesh is unchanged: dropRecord() it and ask for it again.
  Result<void> resplit(NodeIndex node);
  // Hints that the node will be split soon, in the order in which they are to be given, each some
  // splits after the one before: what a split reads is fetched meanwhile (split_records.h).
  enum class Fetch { node, slot, firstFace, ring };
  void prefetch(NodeIndex node, Fetch stage) const;

  // --- what is kept below the front ------------------------------------------------------------
  // Keeps a record for resplit() without splitting; untrusted and not looked at until then. The
  // node may be active or below the front. Nothing happens if it has one; an error for a leaf, a
  // forgotten node or an impossible range of bits.
  Result<void> keepRecord(NodeIndex node, std::span<const uint8_t> bytes, uint64_t bitOffset,
                          uint32_t bitLength);
  // Forgets the node's record and what is below it. False, and nothing is done, if the node is
  // split, or a node below it is pinned.
  bool dropRecord(NodeIndex node, std::vector<NodeId>* forgotten = nullptr);
  // Forgets all nodes below an active node, or one below the front, and their records, so that
  // their memory is used for others; its own record stays. Pinned nodes stay, and so do those on
  // the way to them with their siblings. Returns how many were forgotten; their IDs are appended
  // to `forgotten`. Nothing happens at a node that is split.
  size_t forgetBelow(NodeIndex node, std::vector<NodeId>* forgotten = nullptr);
  // A pinned node is never forgotten: requests for it are under way.
  void setPinned(NodeIndex node, bool pinned) { nodes_[node].set(kPinned, pinned); }
  [[nodiscard]] bool isPinned(NodeIndex node) const { return nodes_[node].has(kPinned); }
  // A number that whoever schedules may leave with a node (FrontBudget does); 0 for a new one.
  void setMark(NodeIndex node, uint16_t mark) { nodes_[node].mark = mark; }
  [[nodiscard]] uint16_t mark(NodeIndex node) const { return nodes_[node].mark; }

  // Bytes that the mesh holds, by the capacity of what holds them. They never shrink: what is
  // forgotten or collapsed makes room for other nodes or splits.
  [[nodiscard]] size_t memoryBytes() const;
  // What a drawer of MeshUpdates is taken to hold: a DrawnVertex and a count for each vertex slot,
  // three corners for each face slot.
  [[nodiscard]] size_t drawerBytes() const { return drawerBytesWith(slots_.size(), drawn_.size()); }
  // memoryBytes() + drawerBytes() once `splits` more vertices are split, `newRecords` of them for
  // the first time.
  [[nodiscard]] size_t bytesAfter(size_t splits, size_t newRecords) const;
  [[nodiscard]] size_t bytes() const { return memoryBytes() + drawerBytes(); }

  // --- drawing ---------------------------------------------------------------------------------
  // By vertex slot; of no meaning for free slots and virtual vertices.
  [[nodiscard]] std::span<const GridPosition> positions() const { return positions_.span(); }
  // By face slot, corners by vertex slot; {0, 0, 0} for what is not drawn.
  [[nodiscard]] std::span<const Triangle> drawnCorners() const { return drawn_.span(); }
  // Grows with every change; a viewer compares it with the last one it uploaded.
  [[nodiscard]] uint64_t changeCount() const { return changes_; }

  // What vertices carry, and by vertex slot how much; empty if they carry nothing.
  [[nodiscard]] const AttributeLayout& attributeLayout() const {
    return base_.tables.attributes.layout;
  }
  [[nodiscard]] std::span<const VertexAttributes> attributes() const { return attributes_.span(); }

  // What has changed since the last call, for a drawer that keeps a copy. The first call gives the
  // whole mesh and starts the tracking, so that what never calls it does not pay. Takes time in
  // proportion to the changes. An update has no limit of its own, since half of one would name
  // vertices that the drawer lacks: bound the splits between two calls instead.
  //  - Free slots and virtual vertices are never part of it: no drawn triangle names them.
  //  - `born` is empty the first time. A slot whose right child came and went is not in it.
  [[nodiscard]] MeshUpdate takeUpdate();
  // Slots of right children that came since then, ascending, while there is tracking.
  template <typename Visit>
  void forEachBorn(const Visit& visit) const {
    if (changed_) changed_->born.forEach(visit);
  }
  // Ends the tracking: the next takeUpdate() gives the whole mesh again.
  void stopUpdates() { changed_.reset(); }

  // The drawn triangles as a plain mesh: used vertices only, in slot order.
  [[nodiscard]] GridMesh snapshot() const;

 private:
  enum : uint8_t { kLeaf = 1, kPinned = 2, kForgotten = 4 };
  // A cache line holds two children.
  struct alignas(32) Node {
    NodeIndex parent = kNone;     // of a forgotten one: the next pair that is free
    NodeIndex leftChild = kNone;  // if known
    VertexSlot slot = kNone;      // on the front or above it
    PredictedNormal normal{0, 0, kNormalLength};
    uint8_t level = 0;
    uint8_t depth = 0;
    uint8_t recordBits = 0;  // kInPool: `record` says where; 0: no record
    uint8_t flags = 0;
    std::array<uint8_t, 8> record{};
    uint16_t mark = 0;

    [[nodiscard]] bool has(uint8_t flag) const { return (flags & flag) != 0; }
    void set(uint8_t flag, bool on) {
      flags = static_cast<uint8_t>(on ? flags | flag : flags & ~flag);
    }
  };
  static_assert(sizeof(Node) == 32);
  static constexpr uint8_t kInPool = 255;
  struct PoolRecord {  // Node::record then
    RecordPool::Place place = 0;
    uint32_t bits = 0;
  };
  // What a split asks of its neighbours, in half a cache line.
  struct alignas(32) Slot {
    NodeId id;  // of the front node
    GridPosition position{};
    // Whose vertex it split off from; a root's own. That slot is in use as long as this one.
    VertexSlot from = 0;
  };
  static_assert(sizeof(Slot) == 32);
  struct Occupant {
    NodeIndex node = kNone;
    uint32_t since = 0;
  };
  struct Bits {
    std::span<const uint8_t> bytes;
    uint64_t begin = 0;
    uint32_t length = 0;
  };

  Result<void> apply(NodeIndex node, const Bits& bits);
  void addChildren(NodeIndex node, const Record& record, const GridPosition& delta);
  void place(NodeIndex node, const HalfEdgeMesh::Split& made, const GridPosition& position);
  void store(Node& node, const Bits& bits);
  void forgetRecord(Node& node);
  bool forgetChildren(NodeIndex node, std::vector<NodeId>* forgotten, size_t& count);
  [[nodiscard]] bool anyPinnedBelow(NodeIndex node) const;
  [[nodiscard]] static size_t drawerBytesWith(size_t vertexSlots, size_t faceSlots);
  [[nodiscard]] bool isVirtualSlot(uint32_t slot) const {
    return slot >= firstVirtual_ && slot < endVirtual_;
  }
  [[nodiscard]] bool isDrawn(FaceSlot face) const { return drawn_[face][0] != drawn_[face][1]; }
  void updateDrawn(FaceSlot face);
  uint32_t gatherRing(VertexSlot slot);
  void noteSplit(VertexSlot kept, const HalfEdgeMesh::Split& made, std::span<const HalfEdge> ring,
                 uint32_t right);
  void noteCollapse(VertexSlot kept, VertexSlot freed, FaceSlot faces);
  [[nodiscard]] DrawnVertex drawnVertex(VertexSlot slot) const;
  [[nodiscard]] PackedNormal normalOfDrawn(VertexSlot slot) const;

  // Since the update before.
  struct ChangedSlots {
    SlotSet vertices;  // those whose normals alone changed follow from `faces`
    SlotSet born;
    SlotSet faces;
    [[nodiscard]] size_t memoryBytes() const {
      return vertices.memoryBytes() + born.memoryBytes() + faces.memoryBytes();
    }
  };

  BaseMesh base_;
  uint32_t firstVirtual_ = 0;  // virtual vertices keep their slots, which equal their nodes
  uint32_t endVirtual_ = 0;
  GrowingArray<Node> nodes_;         // roots, then children in pairs from an even index on
  NodeIndex firstFreePair_ = kNone;  // left ones, linked by `parent`
  size_t freePairs_ = 0;
  GrowingArray<Slot> slots_;  // by vertex slot, as are the next four
  GrowingArray<Occupant> occupants_;
  GrowingArray<GridPosition> positions_;
  GrowingArray<VertexAttributes> attributes_;  // where there are any
  GrowingArray<Triangle> drawn_;               // by face slot
  HalfEdgeMesh edges_;
  RecordPool longRecords_;
  uint64_t drawnCount_ = 0;
  uint64_t splitsApplied_ = 0;
  uint64_t recordsHeld_ = 0;
  uint64_t changes_ = 0;
  std::optional<ChangedSlots> changed_;  // while someone takes updates
  // Working space of apply().
  std::vector<HalfEdge> ring_;
  std::vector<VertexSlot> ends_;  // of ring_
  std::vector<NodeId> entries_;   // their nodes
  // Where find() ended: the way from the root.
  struct FoundPath {
    NodeId id;
    std::array<NodeIndex, kMaxDepth + 1> nodes{};
    bool known = false;
  };
  mutable FoundPath found_;
};

}  // namespace meshfront
