#include "viewer/gl/gpu_mesh.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <string>

#include "viewer/gl/gl_context.h"

namespace meshfront {
namespace {

constexpr GLuint kPositionAttribute = 0;
constexpr GLuint kNormalAttribute = 1;
constexpr GLuint kColourAttribute = 2;

GlBuffer newBuffer() {
  GLuint name = 0;
  glCreateBuffers(1, &name);
  return GlBuffer(name);
}

}  // namespace

GpuMesh::GpuMesh() {
  positions_.buffer = newBuffer();
  normals_.buffer = newBuffer();
  colours_.buffer = newBuffer();
  indices_.buffer = newBuffer();
  GLuint vao = 0;
  glCreateVertexArrays(1, &vao);
  vertexArray_ = GlVertexArray(vao);
  glVertexArrayVertexBuffer(vao, 0, positions_.buffer.name(), 0, sizeof(GridPosition));
  glVertexArrayVertexBuffer(vao, 1, normals_.buffer.name(), 0, sizeof(PackedNormal));
  glVertexArrayVertexBuffer(vao, 2, colours_.buffer.name(), offsetof(VertexAttributes, colour),
                            sizeof(VertexAttributes));
  glVertexArrayElementBuffer(vao, indices_.buffer.name());
  glEnableVertexArrayAttrib(vao, kPositionAttribute);
  glVertexArrayAttribIFormat(vao, kPositionAttribute, 3, GL_INT, 0);
  glVertexArrayAttribBinding(vao, kPositionAttribute, 0);
  glEnableVertexArrayAttrib(vao, kNormalAttribute);
  glVertexArrayAttribFormat(vao, kNormalAttribute, 3, GL_SHORT, GL_TRUE, 0);
  glVertexArrayAttribBinding(vao, kNormalAttribute, 1);
  // Switched on for meshes that have colours.
  glVertexArrayAttribFormat(vao, kColourAttribute, 4, GL_UNSIGNED_BYTE, GL_TRUE, 0);
  glVertexArrayAttribBinding(vao, kColourAttribute, 2);
}

Result<void> GpuMesh::Store::write(std::span<const std::byte> bytes) {
  if (bytes.size() > capacity) {
    // Half as much again: a mesh that streams in grows at every update.
    const size_t wanted = bytes.size() + bytes.size() / 2;
    glNamedBufferData(buffer.name(), static_cast<GLsizeiptr>(wanted), nullptr, GL_DYNAMIC_DRAW);
    if (const std::string errors = takeGlErrors(); !errors.empty()) {
      capacity = 0;
      return fail(ErrorCode::tooLarge, "the GPU has no room for " + std::to_string(wanted) +
                                           " bytes of the mesh (" + errors + ")");
    }
    capacity = wanted;
  }
  glNamedBufferSubData(buffer.name(), 0, static_cast<GLsizeiptr>(bytes.size()), bytes.data());
  return {};
}

Result<bool> GpuMesh::update(const MeshArrays& mesh) {
  if (changeCount_ == mesh.changeCount) {
    return false;
  }
  for (size_t t = 0; t < mesh.corners.size(); ++t) {
    const Triangle& c = mesh.corners[t];
    if (std::max({c[0], c[1], c[2]}) >= mesh.positions.size() && c != Triangle{}) {
      return fail("triangle " + std::to_string(t) + " has a corner beyond the " +
                  std::to_string(mesh.positions.size()) + " vertices");
    }
  }
  if (mesh.positions.size() > INT32_MAX || mesh.corners.size() > INT32_MAX / 3) {
    return fail(ErrorCode::tooLarge, "more than 715 million triangles cannot be drawn at once");
  }
  if (!mesh.coloured.empty() && mesh.coloured.size() != mesh.positions.size())
    return fail("the mesh has " + std::to_string(mesh.coloured.size()) + " colours for " +
                std::to_string(mesh.positions.size()) + " vertices");
  computeVertexNormals(mesh.positions, mesh.corners, normalScratch_);
  for (auto written : {positions_.write(std::as_bytes(mesh.positions)),
                       normals_.write(std::as_bytes(std::span(normalScratch_))),
                       colours_.write(std::as_bytes(mesh.coloured)),
                       indices_.write(std::as_bytes(mesh.corners))}) {
    if (!written) {
      changeCount_.reset();
      vertexCount_ = triangleCount_ = 0;
      corners_.clear();
      return tl::unexpected(written.error());
    }
  }
  corners_.assign(mesh.corners.begin(), mesh.corners.end());
  hasColours_ = !mesh.coloured.empty();
  (hasColours_ ? glEnableVertexArrayAttrib : glDisableVertexArrayAttrib)(vertexArray_.name(),
                                                                         kColourAttribute);
  quantization_ = mesh.quantization;
  vertexCount_ = mesh.positions.size();
  triangleCount_ = mesh.corners.size();
  changeCount_ = mesh.changeCount;
  return true;
}

size_t GpuMesh::byteCount() const {
  return positions_.capacity + normals_.capacity + colours_.capacity + indices_.capacity;
}

bool GpuMesh::fitsShaderStorage() const {
  GLint64 limit = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &limit);
  return std::max(positions_.capacity, indices_.capacity) <= static_cast<uint64_t>(limit);
}

}  // namespace meshfront
