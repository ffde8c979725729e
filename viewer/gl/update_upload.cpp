#include "viewer/gl/update_upload.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>

#include "viewer/gl/gl_context.h"
#include "viewer/gl/shader_program.h"

namespace meshfront {
namespace {

// Sections of the staging buffer begin, and windows on a buffer are cut, at multiples of this many
// bytes: the largest offset alignment that OpenGL allows a driver to ask for.
constexpr size_t kAlignment = 256;
// Records whose size is a multiple of 4 bytes start at such a multiple every so many records.
constexpr size_t kAlignedSlots = kAlignment / sizeof(uint32_t);
// Kept from one update to the next.
constexpr size_t kStagingKept = size_t{32} << 20;
constexpr size_t kScatteredAtOnce = 64;
constexpr size_t kMostScatterGroups = 65'535;

constexpr char kScatterShader[] = R"(#version 450 core
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Slots { uint slots[]; };
layout(std430, binding = 1) readonly buffer Records { uint records[]; };
layout(std430, binding = 2) writeonly buffer Target { uint target[]; };
layout(location = 0) uniform uint firstRecord;  // in the windows on slots and records
layout(location = 1) uniform uint endRecord;
layout(location = 2) uniform uint firstSlot;    // of the window on the target
layout(location = 3) uniform uint words;        // of a slot
layout(location = 4) uniform uint stride;       // words of a record; 0: all slots get `fill`
layout(location = 5) uniform uint firstWord;    // in a record
layout(location = 6) uniform uint fill;
void main() {
  uint record = firstRecord + gl_GlobalInvocationID.x;
  if (record >= endRecord) {
    return;
  }
  uint to = (slots[record] - firstSlot) * words;
  uint from = record * stride + firstWord;
  for (uint w = 0u; w < words; ++w) {
    target[to + w] = stride == 0u ? fill : records[from + w];
  }
}
)";

size_t aligned(size_t bytes) {
  return (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

// Maps the part of a buffer that the slots lie in and lets `write` fill in each slot's bytes.
template <typename Write>
Result<void> writeMapped(const SlotBuffer& into, std::span<const uint32_t> slots, Write write) {
  if (slots.empty()) return {};
  const size_t size = into.bytesPerSlot();
  const size_t first = slots.front() * size;
  const size_t end = (size_t{slots.back()} + 1) * size;
  auto* mapped = static_cast<std::byte*>(
      glMapNamedBufferRange(into.name(), static_cast<GLintptr>(first),
                            static_cast<GLsizeiptr>(end - first), GL_MAP_WRITE_BIT));
  if (mapped == nullptr)
    return fail("a buffer of the mesh cannot be mapped (" + takeGlErrors() + ")");
  for (size_t i = 0; i < slots.size(); ++i) write(i, mapped + (slots[i] * size - first));
  if (glUnmapNamedBuffer(into.name()) != GL_TRUE)
    return fail("the driver has lost the mesh's buffers; open the mesh again");
  return {};
}

}  // namespace

UpdateUpload::Layout::Layout(const MeshUpdate& update) {
  vertices = aligned(update.slots.size() * sizeof(uint32_t));
  born = aligned(vertices + update.vertices.size() * sizeof(DrawnVertex));
  faces = aligned(born + update.born.size() * sizeof(uint32_t));
  corners = aligned(faces + update.faces.size() * sizeof(uint32_t));
  end = corners + update.corners.size() * sizeof(Triangle);
}

UpdateUpload::Way UpdateUpload::preferred() {
  return currentContextIsSoftware() ? Way::map : Way::scatter;
}

UpdateUpload::UpdateUpload(Way wanted, size_t mostWindow) : way_(wanted) {
  if (way_ == Way::map) return;
  auto program = computeProgram("mesh update", kScatterShader);
  if (!program) {
    way_ = Way::map;
    return;
  }
  program_ = std::move(*program);
  GLint64 limit = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &limit);
  window_ = std::min(static_cast<size_t>(limit), mostWindow) / kAlignment * kAlignment;
}

bool UpdateUpload::sendPart(const void* bytes, size_t size, size_t at, size_t& budget) {
  if (size == 0 || sent_ >= at + size) return true;
  const size_t from = sent_ > at ? sent_ - at : 0;
  const size_t count = std::min(budget, size - from);
  if (count > 0)
    glNamedBufferSubData(staging_.name(), static_cast<GLintptr>(at + from),
                         static_cast<GLsizeiptr>(count),
                         static_cast<const std::byte*>(bytes) + from);
  sent_ = at + from + count;
  budget -= count;
  return from + count == size;
}

Result<bool> UpdateUpload::send(const MeshUpdate& update, size_t byteLimit) {
  if (way_ == Way::map) return true;
  const Layout layout(update);
  if (sent_ == 0) {
    if (layout.end > stagingBytes_) {
      GLuint name = 0;
      glCreateBuffers(1, &name);
      staging_ = GlBuffer(name);
      stagingBytes_ = 0;
      glNamedBufferStorage(name, static_cast<GLsizeiptr>(layout.end), nullptr,
                           GL_DYNAMIC_STORAGE_BIT);
      if (const std::string errors = takeGlErrors(); !errors.empty()) {
        staging_ = GlBuffer();
        return fail(ErrorCode::tooLarge, "the GPU has no room for " + std::to_string(layout.end) +
                                             " bytes of changes to the mesh (" + errors + ")");
      }
      stagingBytes_ = layout.end;
    } else if (stagingBytes_ > 0) {
      glInvalidateBufferData(staging_.name());  // the last update may still be read
    }
  }
  size_t budget = byteLimit;
  const auto send = [&](const auto& list, size_t at) {
    return sendPart(list.data(), list.size() * sizeof(list[0]), at, budget);
  };
  return send(update.slots, layout.slots) && send(update.vertices, layout.vertices) &&
         send(update.born, layout.born) && send(update.faces, layout.faces) &&
         send(update.corners, layout.corners);
}

Result<void> UpdateUpload::commit(const MeshUpdate& update, float birth,
                                  const MeshBuffers& buffers) {
  if (way_ == Way::scatter) {
    scatterAll(update, birth, buffers);
    return {};
  }
  for (const auto& written :
       {writeMapped(
            buffers.positions, update.slots,
            [&](size_t i, std::byte*to) { std::memcpy(to, &update.vertices[i], kPositionBytes); }),
        writeMapped(buffers.rest, update.slots,
                    [&](size_t i, std::byte*to) {
                      const auto* record = reinterpret_cast<const std::byte*>(&update.vertices[i]);
                      std::memcpy(to, record + kPositionBytes, kRestBytes);
                    }),
        writeMapped(buffers.births, update.born,
                    [&](size_t, std::byte*to) { std::memcpy(to, &birth, sizeof birth); }),
        writeMapped(buffers.corners, update.faces, [&](size_t i, std::byte*to) {
          std::memcpy(to, &update.corners[i], sizeof(Triangle));
        })}) {
    if (!written) return written;
  }
  return {};
}

void UpdateUpload::scatterAll(const MeshUpdate& update, float birth, const MeshBuffers& buffers) {
  const Layout layout(update);
  glUseProgram(program_.name());
  constexpr size_t kRecord = sizeof(DrawnVertex);
  scatter({update.slots, layout.slots, layout.vertices, kRecord, 0, 0}, buffers.positions);
  scatter({update.slots, layout.slots, layout.vertices, kRecord, kPositionBytes, 0}, buffers.rest);
  scatter({update.born, layout.born, layout.born, 0, 0, std::bit_cast<uint32_t>(birth)},
          buffers.births);
  scatter({update.faces, layout.faces, layout.corners, sizeof(Triangle), 0, 0}, buffers.corners);
  glMemoryBarrier(GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT |
                  GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  sent_ = 0;
  if (stagingBytes_ > kStagingKept) {
    staging_ = GlBuffer();
    stagingBytes_ = 0;
  }
}

void UpdateUpload::scatter(const Records& records, const SlotBuffer& into) const {
  const size_t slotBytes = into.bytesPerSlot();
  const size_t recordBytes = std::max({records.stride, slotBytes, sizeof(uint32_t)});
  // As much at a time as a shader may see of the staging buffer, and of the target.
  const size_t mostRecords =
      std::min(window_ / recordBytes - kAlignedSlots, kMostScatterGroups * kScatteredAtOnce);
  const size_t mostSlots = window_ / slotBytes;
  const auto bind = [](GLuint binding, GLuint buffer, size_t from, size_t size) {
    glBindBufferRange(GL_SHADER_STORAGE_BUFFER, binding, buffer, static_cast<GLintptr>(from),
                      static_cast<GLsizeiptr>(size));
  };
  for (size_t i = 0; i < records.slots.size();) {
    const size_t windowRecord = i / kAlignedSlots * kAlignedSlots;
    const size_t windowSlot = records.slots[i] / kAlignedSlots * kAlignedSlots;
    const auto most = std::min(records.slots.size(), i + mostRecords);
    const auto begin = records.slots.begin();
    const auto end = static_cast<size_t>(std::lower_bound(begin + static_cast<std::ptrdiff_t>(i),
                                                          begin + static_cast<std::ptrdiff_t>(most),
                                                          windowSlot + mostSlots) -
                                         begin);
    bind(0, staging_.name(), records.slotsAt + windowRecord * sizeof(uint32_t),
         (end - windowRecord) * sizeof(uint32_t));
    const size_t data = records.data + windowRecord * records.stride;
    bind(1, staging_.name(), data,
         std::max((end - windowRecord) * records.stride, sizeof(uint32_t)));
    bind(2, into.name(), windowSlot * slotBytes,
         std::min(window_, into.byteCount() - windowSlot * slotBytes));
    glUniform1ui(0, static_cast<GLuint>(i - windowRecord));
    glUniform1ui(1, static_cast<GLuint>(end - windowRecord));
    glUniform1ui(2, static_cast<GLuint>(windowSlot));
    glUniform1ui(3, static_cast<GLuint>(slotBytes / sizeof(uint32_t)));
    glUniform1ui(4, static_cast<GLuint>(records.stride / sizeof(uint32_t)));
    glUniform1ui(5, static_cast<GLuint>(records.first / sizeof(uint32_t)));
    glUniform1ui(6, records.fill);
    glDispatchCompute(static_cast<GLuint>((end - i + kScatteredAtOnce - 1) / kScatteredAtOnce), 1,
                      1);
    i = end;
  }
}

}  // namespace meshfront
