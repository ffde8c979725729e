#include "viewer/gl/pixel_buffers.h"

#include <epoxy/gl.h>

namespace meshfront {

Result<void> PixelBuffers::set(std::span<const std::vector<uint32_t>> pixels) {
  while (buffers_.size() < pixels.size())
    buffers_.emplace_back(sizeof(uint32_t), 0, SlotAccess::upload);
  for (size_t i = 0; i < buffers_.size(); ++i) {
    const size_t counted = i < pixels.size() ? pixels[i].size() : 0;
    SlotBuffer& buffer = buffers_[i];
    if (Result<void> held = buffer.hold(counted); !held) return held;
    if (buffer.name() == 0) continue;
    const auto bytes = static_cast<GLsizeiptr>(counted * sizeof(uint32_t));
    if (bytes > 0) glNamedBufferSubData(buffer.name(), 0, bytes, pixels[i].data());
    const GLuint zero = 0;
    glClearNamedBufferSubData(buffer.name(), GL_R32UI, bytes,
                              static_cast<GLsizeiptr>(buffer.byteCount()) - bytes, GL_RED_INTEGER,
                              GL_UNSIGNED_INT, &zero);
  }
  return {};
}

GlName PixelBuffers::buffer(size_t instance, size_t slots) {
  if (instance >= buffers_.size() || !buffers_[instance].hold(slots)) return 0;
  return buffers_[instance].name();
}

}  // namespace meshfront
