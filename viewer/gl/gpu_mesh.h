// A mesh in GPU buffers, changed by MeshUpdates.
//
//   GpuMesh gpuMesh(quantization, coloured);
//   gpuMesh.apply(mesh.takeUpdate(), seconds, 8 << 20);   // once a frame, also while isPending()
//
// Nothing is uploaded twice: a mesh that outgrows its buffers is copied on the GPU.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "shared/mesh/indexed_mesh.h"
#include "shared/mesh/quantization.h"
#include "shared/refinement/mesh_update.h"
#include "shared/result.h"
#include "viewer/gl/gl_object.h"
#include "viewer/gl/mesh_arrays.h"
#include "viewer/gl/slot_buffer.h"
#include "viewer/gl/update_upload.h"

namespace meshfront {

class GpuMesh {
 public:
  static constexpr size_t kNoLimit = SIZE_MAX;

  // Needs a current context. `coloured`: the vertices' colours mean something.
  explicit GpuMesh(const Quantization& quantization = {}, bool coloured = false,
                   UpdateUpload::Way way = UpdateUpload::preferred());
  GpuMesh(GpuMesh&&) noexcept = default;
  GpuMesh& operator=(GpuMesh&&) noexcept = default;

  // Takes an update and works on those taken, oldest first. `now`, seconds on the caller's clock
  // that never goes back, is when the vertices born begin to slide. Uploads about `byteLimit` bytes
  // at most; what is left over goes up with the next calls, and until all of an update is there the
  // mesh stays as it was before, whole. Says whether the mesh has changed.
  // Errors (each leaves the mesh drawable, without the update): lists that do not match or are not
  // ascending, slots or corners out of range, fewer slots than before, no GPU memory.
  Result<bool> apply(MeshUpdate update, double now = 0, size_t byteLimit = kNoLimit);
  // Works on those taken.
  Result<bool> advance(double now = 0, size_t byteLimit = kNoLimit);
  [[nodiscard]] bool isPending() const { return !pending_.empty(); }

  // A mesh that lies in memory, instead of what was there: as one update, unless this change count
  // is already there; says whether it did. Arrays of one mesh only (a change count means nothing
  // across meshes). A triangle with a corner out of range is an error and changes nothing.
  Result<bool> update(const MeshArrays& mesh);

  // Room for a mesh whose size is known beforehand, so that it need not grow.
  Result<void> reserve(size_t vertexSlots, size_t faceSlots);

  [[nodiscard]] const Quantization& quantization() const { return quantization_; }
  // Of the mesh that is drawn: what a count of its pixels belongs to.
  [[nodiscard]] std::optional<uint64_t> changeCount() const { return changeCount_; }
  [[nodiscard]] size_t vertexCount() const { return vertexCount_; }       // slots
  [[nodiscard]] size_t triangleCount() const { return corners_.size(); }  // undrawn slots included
  [[nodiscard]] bool hasColours() const { return coloured_; }
  // Has, or had, a colour whose alpha is below 255.
  [[nodiscard]] bool isTranslucent() const { return translucent_; }
  // On the GPU, exactly: 52 bytes a vertex slot and 12 a face slot, room to grow (a quarter at
  // most) and what is being uploaded (32 MB or less between large updates) included.
  [[nodiscard]] size_t byteCount() const;
  // The corners drawn, for counting and picking on the CPU.
  [[nodiscard]] std::span<const Triangle> corners() const { return corners_; }
  // When the last vertex born began to slide; long ago where none did.
  [[nodiscard]] double lastBirth() const { return lastBirth_; }
  // What birth times on the GPU count from.
  [[nodiscard]] double epoch() const { return epoch_.value_or(0); }
  // Of a slot below vertexCount(), read from the GPU: waits for it.
  [[nodiscard]] DrawnVertex vertexAt(uint32_t slot) const;

  // For the renderer and the counter. Names change when the mesh grows.
  [[nodiscard]] GlName vertexArray() const { return vertexArray_.name(); }
  [[nodiscard]] GlName positionBuffer() const { return positions_.name(); }
  [[nodiscard]] GlName restBuffer() const { return rest_.name(); }
  [[nodiscard]] GlName birthBuffer() const { return births_.name(); }
  [[nodiscard]] GlName cornerBuffer() const { return indices_.name(); }
  // Shaders may index the buffers (they are within the driver's limit on storage blocks).
  [[nodiscard]] bool fitsShaderStorage() const;

 private:
  [[nodiscard]] MeshBuffers buffers() { return {positions_, rest_, births_, indices_}; }
  Result<void> commit(const MeshUpdate& update, double now);
  void attachBuffers();

  Quantization quantization_;
  bool coloured_;
  bool translucent_ = false;
  UpdateUpload upload_;
  SlotBuffer positions_;
  SlotBuffer rest_;
  SlotBuffer births_;
  SlotBuffer indices_;
  GlVertexArray vertexArray_;
  std::optional<uint64_t> changeCount_;
  size_t vertexCount_ = 0;
  std::vector<Triangle> corners_;
  std::deque<MeshUpdate> pending_;
  std::optional<double> epoch_;
  double lastBirth_ = -std::numeric_limits<double>::infinity();
};

}  // namespace meshfront
