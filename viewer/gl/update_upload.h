// The way of a MeshUpdate into GPU buffers. Two ways, measured:
//  - scatter, for GPUs: the update goes as it is, in one piece or in slices, into a staging buffer,
//    and a compute shader puts its records where they belong. Uploading range by range costs a
//    driver call a run of neighbouring slots, and the slots of splits are scattered.
//  - map, where the CPU draws: the records are written straight into the mapped buffers, which is
//    ten times as fast there as any other way.
// Either way the buffers change in one step, when all of the update is there: a picture in between
// shows the mesh as it was before, whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "shared/refinement/mesh_update.h"
#include "shared/result.h"
#include "viewer/gl/gl_object.h"
#include "viewer/gl/slot_buffer.h"

namespace meshfront {

// A vertex's record is split in two, so that what needs positions alone reads nothing else.
inline constexpr size_t kPositionBytes = sizeof(GridPosition);
inline constexpr size_t kRestBytes = sizeof(DrawnVertex) - kPositionBytes;

struct MeshBuffers {
  SlotBuffer& positions;  // the start of a DrawnVertex
  SlotBuffer& rest;       // what follows there
  SlotBuffer& births;     // float, seconds: when the vertex began to slide
  SlotBuffer& corners;    // Triangle
};

class UpdateUpload {
 public:
  enum class Way { map, scatter };
  // For the current context.
  [[nodiscard]] static Way preferred();
  // Falls back to mapping where the shader cannot be built.
  // `mostWindow`: how much of a buffer a shader sees at a time if the driver allows more, 16 KiB or
  // more.
  explicit UpdateUpload(Way wanted = preferred(), size_t mostWindow = SIZE_MAX);

  // What the mesh's buffers must allow.
  [[nodiscard]] SlotAccess access() const {
    return way_ == Way::map ? SlotAccess::map : SlotAccess::none;
  }

  // Sends up to `byteLimit` further bytes of the update, which must be the same in each call until
  // it is there; true: all of it is.
  Result<bool> send(const MeshUpdate& update, size_t byteLimit);
  // Then puts it into the buffers, which must hold all its slots.
  Result<void> commit(const MeshUpdate& update, float birth, const MeshBuffers& buffers);

  // Forgets what was sent of an update that will not be committed.
  void abandon() { sent_ = 0; }

  [[nodiscard]] size_t byteCount() const { return stagingBytes_; }

 private:
  // Where the parts of an update lie in the staging buffer.
  struct Layout {
    size_t slots = 0;
    size_t vertices = 0;
    size_t born = 0;
    size_t faces = 0;
    size_t corners = 0;
    size_t end = 0;
    explicit Layout(const MeshUpdate& update);
  };
  // Records of `stride` bytes at `data` in the staging buffer; of each, `bytes` from `first` on go
  // to its slot. Without a stride the slots get `fill`.
  struct Records {
    std::span<const uint32_t> slots;
    size_t slotsAt = 0;
    size_t data = 0;
    size_t stride = 0;
    size_t first = 0;
    uint32_t fill = 0;
  };
  bool sendPart(const void* bytes, size_t size, size_t at, size_t& budget);
  void scatter(const Records& records, const SlotBuffer& into) const;
  void scatterAll(const MeshUpdate& update, float birth, const MeshBuffers& buffers);

  Way way_;
  GlProgram program_;
  size_t window_ = 0;  // bytes that a shader sees of a buffer
  GlBuffer staging_;
  size_t stagingBytes_ = 0;
  size_t sent_ = 0;  // bytes of the update under way, by place in the staging buffer
};

}  // namespace meshfront
