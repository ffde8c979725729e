#include "viewer/gl/slot_buffer.h"

#include <epoxy/gl.h>

#include <string>
#include <utility>

#include "viewer/gl/gl_context.h"

namespace meshfront {

namespace {

GLbitfield storageFlags(SlotAccess access) {
  switch (access) {
    case SlotAccess::map:
      return GL_MAP_WRITE_BIT;
    case SlotAccess::upload:
      return GL_DYNAMIC_STORAGE_BIT;
    case SlotAccess::none:
      break;
  }
  return 0;
}

}  // namespace

Result<void> SlotBuffer::hold(size_t slots) {
  if (slots <= capacity_) return {};
  // A quarter more than needed: a mesh that streams in grows at every update. The first time it is
  // exact, for meshes that come whole.
  const size_t wanted = capacity_ == 0 ? slots : slots + slots / 4;
  const auto bytes = static_cast<GLsizeiptr>(wanted * bytesPerSlot_);
  GLuint name = 0;
  glCreateBuffers(1, &name);
  GlBuffer grown(name);
  glNamedBufferStorage(name, bytes, nullptr, storageFlags(access_));
  if (const std::string errors = takeGlErrors(); !errors.empty())
    return fail(ErrorCode::tooLarge, "the GPU has no room for " + std::to_string(bytes) +
                                         " bytes of the mesh (" + errors + ")");
  const auto held = static_cast<GLsizeiptr>(byteCount());
  if (held > 0) glCopyNamedBufferSubData(buffer_.name(), name, 0, 0, held);
  glClearNamedBufferSubData(name, GL_R32UI, held, bytes - held, GL_RED_INTEGER, GL_UNSIGNED_INT,
                            &fill_);
  buffer_ = std::move(grown);
  capacity_ = wanted;
  return {};
}

}  // namespace meshfront
