#include "viewer/gl/render_target.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <string>

#include "viewer/gl/gl_context.h"

namespace meshfront {
namespace {

GlTexture newTexture(GLenum format, PixelSize size) {
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &name);
  glTextureStorage2D(name, 1, format, size.width, size.height);
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  return GlTexture(name);
}

}  // namespace

Result<RenderTarget> RenderTarget::create(PixelSize size) {
  RenderTarget target;
  if (auto made = target.resize(size); !made) {
    return tl::unexpected(made.error());
  }
  return target;
}

Result<void> RenderTarget::resize(PixelSize size) {
  if (size == size_) {
    return {};
  }
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  const std::string text = std::to_string(size.width) + "x" + std::to_string(size.height);
  if (size.width < 1 || size.height < 1 || size.width > limit || size.height > limit) {
    return fail("a picture of " + text + " pixels cannot be drawn: each side must be 1 to " +
                std::to_string(limit));
  }
  RenderTarget made;
  made.size_ = size;
  made.colour_ = newTexture(GL_RGBA8, size);
  made.depth_ = newTexture(GL_DEPTH_COMPONENT32F, size);
  made.items_ = newTexture(GL_R32UI, size);
  GLuint fbo = 0;
  glCreateFramebuffers(1, &fbo);
  made.framebuffer_ = GlFramebuffer(fbo);
  glNamedFramebufferTexture(fbo, GL_COLOR_ATTACHMENT0, made.colour_.name(), 0);
  glNamedFramebufferTexture(fbo, GL_COLOR_ATTACHMENT1, made.items_.name(), 0);
  glNamedFramebufferTexture(fbo, GL_DEPTH_ATTACHMENT, made.depth_.name(), 0);
  const GLenum status = glCheckNamedFramebufferStatus(fbo, GL_DRAW_FRAMEBUFFER);
  const std::string errors = takeGlErrors();
  if (status != GL_FRAMEBUFFER_COMPLETE || !errors.empty()) {
    return fail(ErrorCode::tooLarge, "the GPU cannot make a picture of " + text + " pixels (" +
                                         (errors.empty() ? std::to_string(status) : errors) + ")");
  }
  *this = std::move(made);
  return {};
}

Picture RenderTarget::readPicture() const {
  Picture picture;
  picture.width = size_.width;
  picture.height = size_.height;
  const size_t row = size_t{3} * static_cast<size_t>(size_.width);
  const auto height = static_cast<size_t>(size_.height);
  picture.rgb.resize(row * height);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.name());
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, size_.width, size_.height, GL_RGB, GL_UNSIGNED_BYTE, picture.rgb.data());
  for (size_t y = 0; y < height / 2; ++y) {
    std::swap_ranges(picture.rgb.begin() + static_cast<std::ptrdiff_t>(y * row),
                     picture.rgb.begin() + static_cast<std::ptrdiff_t>((y + 1) * row),
                     picture.rgb.begin() + static_cast<std::ptrdiff_t>((height - 1 - y) * row));
  }
  return picture;
}

void RenderTarget::readItems(std::vector<uint32_t>& items) const {
  items.resize(static_cast<size_t>(size_.width) * static_cast<size_t>(size_.height));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.name());
  glReadBuffer(GL_COLOR_ATTACHMENT1);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, size_.width, size_.height, GL_RED_INTEGER, GL_UNSIGNED_INT, items.data());
}

float RenderTarget::depthAt(int x, int y) const {
  if (x < 0 || y < 0 || x >= size_.width || y >= size_.height) {
    return 0;
  }
  float depth = 0;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.name());
  glReadPixels(x, size_.height - 1 - y, 1, 1, GL_DEPTH_COMPONENT, GL_FLOAT, &depth);
  return depth;
}

uint32_t RenderTarget::itemAt(int x, int y) const {
  if (x < 0 || y < 0 || x >= size_.width || y >= size_.height) {
    return 0;
  }
  GLuint item = 0;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.name());
  glReadBuffer(GL_COLOR_ATTACHMENT1);
  glReadPixels(x, size_.height - 1 - y, 1, 1, GL_RED_INTEGER, GL_UNSIGNED_INT, &item);
  return item;
}

void RenderTarget::blitToWindow(PixelSize window) const {
  glNamedFramebufferReadBuffer(framebuffer_.name(), GL_COLOR_ATTACHMENT0);
  glBlitNamedFramebuffer(framebuffer_.name(), 0, 0, 0, size_.width, size_.height, 0, 0,
                         window.width, window.height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

}  // namespace meshfront
