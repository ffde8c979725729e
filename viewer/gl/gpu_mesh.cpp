#include "viewer/gl/gpu_mesh.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <string>
#include <utility>

#include "viewer/gl/mesh_attributes.h"

namespace meshfront {
namespace {

// Slots that were never born have been where they are for ever.
constexpr float kLongAgo = -1e30F;

Result<void> checkAscending(std::span<const uint32_t> slots, size_t limit, const char* what) {
  for (size_t i = 0; i < slots.size(); ++i) {
    if (slots[i] >= limit)
      return fail(std::string(what) + " " + std::to_string(slots[i]) + " lies beyond the mesh's " +
                  std::to_string(limit));
    if (i > 0 && slots[i] <= slots[i - 1])
      return fail(std::string(what) + "s are not in ascending order at " +
                  std::to_string(slots[i]));
  }
  return {};
}

// `vertexSlots`, `faceSlots`: of the mesh before.
Result<void> checkUpdate(const MeshUpdate& update, size_t vertexSlots, size_t faceSlots) {
  if (update.slots.size() != update.vertices.size() || update.faces.size() != update.corners.size())
    return fail("an update of the mesh has not one vertex a slot and three corners a face");
  if (update.vertexSlots < vertexSlots || update.faceSlots < faceSlots)
    return fail("an update of the mesh takes slots away");
  if (update.vertexSlots > INT32_MAX || update.faceSlots > INT32_MAX / 3)
    return fail(ErrorCode::tooLarge, "more than 715 million triangles cannot be drawn at once");
  for (const auto& checked : {checkAscending(update.slots, update.vertexSlots, "vertex slot"),
                              checkAscending(update.born, update.vertexSlots, "vertex slot"),
                              checkAscending(update.faces, update.faceSlots, "face slot")}) {
    if (!checked) return checked;
  }
  for (size_t i = 0; i < update.corners.size(); ++i) {
    const Triangle& c = update.corners[i];
    if (std::max({c[0], c[1], c[2]}) >= update.vertexSlots && c != Triangle{})
      return fail("triangle " + std::to_string(update.faces[i]) + " has a corner beyond the " +
                  std::to_string(update.vertexSlots) + " vertices");
  }
  return {};
}

}  // namespace

GpuMesh::GpuMesh(const Quantization& quantization, bool coloured, UpdateUpload::Way way)
    : quantization_(quantization),
      coloured_(coloured),
      upload_(way),
      positions_(kPositionBytes, 0, upload_.access()),
      rest_(kRestBytes, 0, upload_.access()),
      births_(sizeof(float), std::bit_cast<uint32_t>(kLongAgo), upload_.access()),
      indices_(sizeof(Triangle), 0, upload_.access()) {
  GLuint vao = 0;
  glCreateVertexArrays(1, &vao);
  vertexArray_ = GlVertexArray(vao);
  const auto inRest = [](size_t offset) { return static_cast<GLuint>(offset - kPositionBytes); };
  const auto whole = [vao](GLuint attribute, GLint size, GLenum type, GLuint offset,
                           GLuint binding) {
    glEnableVertexArrayAttrib(vao, attribute);
    glVertexArrayAttribIFormat(vao, attribute, size, type, offset);
    glVertexArrayAttribBinding(vao, attribute, binding);
  };
  const auto real = [vao](GLuint attribute, GLint size, GLenum type, GLuint offset,
                          GLuint binding) {
    glEnableVertexArrayAttrib(vao, attribute);
    glVertexArrayAttribFormat(vao, attribute, size, type, type == GL_FLOAT ? GL_FALSE : GL_TRUE,
                              offset);
    glVertexArrayAttribBinding(vao, attribute, binding);
  };
  whole(kPositionAttribute, 3, GL_INT, 0, 0);
  whole(kFromAttribute, 3, GL_INT, inRest(offsetof(DrawnVertex, from)), 1);
  real(kNormalAttribute, 3, GL_SHORT, inRest(offsetof(DrawnVertex, normal)), 1);
  real(kColourAttribute, 4, GL_UNSIGNED_BYTE, inRest(offsetof(DrawnVertex, colour)), 1);
  whole(kTreeAttribute, 1, GL_UNSIGNED_INT, inRest(offsetof(DrawnVertex, tree)), 1);
  whole(kStateAttribute, 4, GL_UNSIGNED_BYTE, inRest(offsetof(DrawnVertex, level)), 1);
  real(kBirthAttribute, 1, GL_FLOAT, 0, 2);
  // Switched on by the renderer where pixels are shown.
  glVertexArrayAttribIFormat(vao, kPixelAttribute, 1, GL_UNSIGNED_INT, 0);
  glVertexArrayAttribBinding(vao, kPixelAttribute, kPixelBinding);
}

void GpuMesh::attachBuffers() {
  const GLuint vao = vertexArray_.name();
  glVertexArrayVertexBuffer(vao, 0, positions_.name(), 0, kPositionBytes);
  glVertexArrayVertexBuffer(vao, 1, rest_.name(), 0, kRestBytes);
  glVertexArrayVertexBuffer(vao, 2, births_.name(), 0, sizeof(float));
  glVertexArrayElementBuffer(vao, indices_.name());
}

Result<void> GpuMesh::reserve(size_t vertexSlots, size_t faceSlots) {
  Result<void> held;
  for (SlotBuffer* buffer : {&positions_, &rest_, &births_, &indices_}) {
    held = buffer->hold(buffer == &indices_ ? faceSlots : vertexSlots);
    if (!held) break;
  }
  attachBuffers();
  return held;
}

Result<bool> GpuMesh::apply(MeshUpdate update, double now, size_t byteLimit) {
  const bool first = pending_.empty();
  if (Result<void> checked = checkUpdate(update, first ? vertexCount_ : pending_.back().vertexSlots,
                                         first ? corners_.size() : pending_.back().faceSlots);
      !checked)
    return tl::unexpected(checked.error());
  pending_.push_back(std::move(update));
  return advance(now, byteLimit);
}

Result<bool> GpuMesh::advance(double now, size_t byteLimit) {
  bool changed = false;
  size_t left = byteLimit;
  while (!pending_.empty() && left > 0) {
    const MeshUpdate& update = pending_.front();
    const size_t bytes = update.byteCount();
    const Result<bool> sent = upload_.send(update, left);
    if (sent && !*sent) return changed;
    const Result<void> done = sent ? commit(update, now) : tl::unexpected(sent.error());
    if (!done) {
      upload_.abandon();
      pending_.clear();  // those behind it build on it
      return tl::unexpected(done.error());
    }
    pending_.pop_front();
    left -= std::min(left, bytes);
    changed = true;
  }
  return changed;
}

Result<void> GpuMesh::commit(const MeshUpdate& update, double now) {
  if (Result<void> held = reserve(update.vertexSlots, update.faceSlots); !held) return held;
  if (!epoch_) epoch_ = now;
  if (Result<void> written = upload_.commit(update, static_cast<float>(now - *epoch_), buffers());
      !written)
    return written;
  vertexCount_ = update.vertexSlots;
  corners_.resize(update.faceSlots);
  for (size_t i = 0; i < update.faces.size(); ++i) corners_[update.faces[i]] = update.corners[i];
  if (coloured_ && !translucent_)
    translucent_ = std::any_of(update.vertices.begin(), update.vertices.end(),
                               [](const DrawnVertex& vertex) { return vertex.colour[3] != 255; });
  if (!update.born.empty()) lastBirth_ = now;
  changeCount_ = update.changeCount;
  return {};
}

Result<bool> GpuMesh::update(const MeshArrays& mesh) {
  if (changeCount_ == mesh.changeCount) return false;
  Result<MeshUpdate> whole = updateFrom(mesh);
  if (!whole) return tl::unexpected(whole.error());
  upload_.abandon();
  pending_.clear();
  corners_.clear();
  vertexCount_ = 0;
  changeCount_.reset();
  translucent_ = false;
  quantization_ = mesh.quantization;
  coloured_ = !mesh.coloured.empty();
  return apply(std::move(*whole));
}

size_t GpuMesh::byteCount() const {
  return positions_.byteCount() + rest_.byteCount() + births_.byteCount() + indices_.byteCount() +
         upload_.byteCount();
}

DrawnVertex GpuMesh::vertexAt(uint32_t slot) const {
  DrawnVertex vertex;
  std::array<std::byte, sizeof(DrawnVertex)> bytes{};
  glGetNamedBufferSubData(positions_.name(), static_cast<GLintptr>(slot * kPositionBytes),
                          kPositionBytes, bytes.data());
  glGetNamedBufferSubData(rest_.name(), static_cast<GLintptr>(slot * kRestBytes), kRestBytes,
                          bytes.data() + kPositionBytes);
  std::memcpy(&vertex, bytes.data(), bytes.size());
  return vertex;
}

bool GpuMesh::fitsShaderStorage() const {
  GLint64 limit = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &limit);
  return std::max(rest_.byteCount(), indices_.byteCount()) <= static_cast<uint64_t>(limit);
}

}  // namespace meshfront
