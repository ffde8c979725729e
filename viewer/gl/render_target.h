// Where everything is drawn, in a window and without one: colour RGBA8, depth (32-bit float,
// reversed: 0 is background) and the item buffer R32UI, which holds for each pixel the visible
// triangle's item (mesh_instance.h), or 0. Of a mesh alone that is its face slot + 1.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/camera/camera.h"
#include "shared/result.h"
#include "viewer/gl/gl_object.h"
#include "viewer/picture/picture.h"

namespace meshfront {

class RenderTarget {
 public:
  // Sides of 1 to the driver's limit (16384 or more).
  [[nodiscard]] static Result<RenderTarget> create(PixelSize size);

  // Contents are lost unless the size is the same. On an error nothing has changed.
  Result<void> resize(PixelSize size);
  [[nodiscard]] PixelSize size() const { return size_; }

  [[nodiscard]] Picture readPicture() const;
  // Rows from the bottom, as GL has them. `items` is reused storage.
  void readItems(std::vector<uint32_t>& items) const;
  // At a pixel counted from the upper left; 0 = background or outside.
  [[nodiscard]] float depthAt(int x, int y) const;
  // Likewise.
  [[nodiscard]] uint32_t itemAt(int x, int y) const;
  // Copies the colours to the window whose context is current.
  void blitToWindow(PixelSize window) const;

  [[nodiscard]] GlName framebuffer() const { return framebuffer_.name(); }
  [[nodiscard]] GlName itemTexture() const { return items_.name(); }

 private:
  RenderTarget() = default;
  PixelSize size_;
  GlTexture colour_;
  GlTexture depth_;
  GlTexture items_;
  GlFramebuffer framebuffer_;
};

}  // namespace meshfront
