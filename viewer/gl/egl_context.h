// A current OpenGL 4.5 core context without a display, a window or a surface, by EGL.
// In a file of its own because EGL's headers and libepoxy's do not go together.
#pragma once

#include <string>
#include <vector>

namespace meshfront {

// A way to an EGL display.
struct EglPlatform {
  unsigned platform = 0;   // EGLenum
  void* device = nullptr;  // EGLDeviceEXT, null for none
  std::string name;
};

// In the order they should be tried: GPUs, Mesa without a device, Mesa's software device.
[[nodiscard]] std::vector<EglPlatform> eglPlatforms();

class EglContext {
 public:
  EglContext() = default;
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;
  ~EglContext();

  // Makes the context and makes it current; the reason it failed, or an empty text. Call once.
  [[nodiscard]] std::string open(const EglPlatform& platform);

 private:
  void* display_ = nullptr;
  void* context_ = nullptr;
};

}  // namespace meshfront
