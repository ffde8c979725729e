// A mesh's arrays in GPU buffers, uploaded when they changed.
//
//   auto gpuMesh = GpuMesh::create();
//   gpuMesh->update({mesh.base().quantization, mesh.positions(), mesh.drawnCorners(),
//                    mesh.changeCount()});
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/mesh/indexed_mesh.h"
#include "shared/mesh/quantization.h"
#include "shared/mesh/vertex_attributes.h"
#include "shared/mesh/vertex_normals.h"
#include "shared/result.h"
#include "viewer/gl/gl_object.h"

namespace meshfront {

// A mesh as it lies in memory; the spans need to live only through the call.
struct MeshArrays {
  Quantization quantization;
  std::span<const GridPosition> positions;  // by vertex slot
  std::span<const Triangle> corners;        // by face slot, vertex slots; all equal = not drawn
  uint64_t changeCount = 0;                 // equal = the arrays are as they were
  // By vertex slot, for their colours (sRGB; alpha is not drawn); empty: the mesh has none.
  std::span<const VertexAttributes> coloured{};
};

class GpuMesh {
 public:
  GpuMesh();
  GpuMesh(GpuMesh&&) noexcept = default;
  GpuMesh& operator=(GpuMesh&&) noexcept = default;

  // Uploads unless this change count is already there; says whether it did. Arrays of one mesh only
  // (a change count means nothing across meshes). A triangle with a corner out of range is an error
  // and leaves the previous arrays.
  Result<bool> update(const MeshArrays& mesh);

  [[nodiscard]] const Quantization& quantization() const { return quantization_; }
  [[nodiscard]] size_t vertexCount() const { return vertexCount_; }
  [[nodiscard]] size_t triangleCount() const { return triangleCount_; }  // undrawn slots included
  [[nodiscard]] bool hasColours() const { return hasColours_; }
  [[nodiscard]] size_t byteCount() const;  // on the GPU, capacity
  // The corners last uploaded, for counting on the CPU.
  [[nodiscard]] std::span<const Triangle> corners() const { return corners_; }

  // For the renderer and the counter.
  [[nodiscard]] GlName vertexArray() const { return vertexArray_.name(); }
  [[nodiscard]] GlName positionBuffer() const { return positions_.buffer.name(); }
  [[nodiscard]] GlName cornerBuffer() const { return indices_.buffer.name(); }
  // Shaders may index the buffers (they are within the driver's limit on storage blocks).
  [[nodiscard]] bool fitsShaderStorage() const;

 private:
  struct Store {
    GlBuffer buffer;
    size_t capacity = 0;
    Result<void> write(std::span<const std::byte> bytes);
  };
  Store positions_;
  Store normals_;
  Store colours_;
  Store indices_;
  GlVertexArray vertexArray_;
  Quantization quantization_;
  std::optional<uint64_t> changeCount_;
  size_t vertexCount_ = 0;
  size_t triangleCount_ = 0;
  bool hasColours_ = false;
  std::vector<Triangle> corners_;
  std::vector<PackedNormal> normalScratch_;
};

}  // namespace meshfront
