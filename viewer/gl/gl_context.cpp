#include "viewer/gl/gl_context.h"

#include <epoxy/gl.h>

#include <utility>

#include "viewer/gl/egl_context.h"

namespace meshfront {
namespace {

constexpr int kMajor = 4;
constexpr int kMinor = 5;

std::string glText(GLenum what) {
  const auto* text = reinterpret_cast<const char*>(glGetString(what));
  return text == nullptr ? "" : text;
}

}  // namespace

GlContext::GlContext(std::unique_ptr<EglContext> egl, std::string source)
    : egl_(std::move(egl)),
      source_(std::move(source)),
      renderer_(glText(GL_RENDERER)),
      version_(glText(GL_VERSION)),
      software_(currentContextIsSoftware()) {}
GlContext::GlContext(GlContext&&) noexcept = default;
GlContext& GlContext::operator=(GlContext&&) noexcept = default;
GlContext::~GlContext() = default;

Result<GlContext> GlContext::checked(std::unique_ptr<EglContext> egl, std::string source) {
  if (!epoxy_is_desktop_gl() || epoxy_gl_version() < 10 * kMajor + kMinor) {
    return fail(ErrorCode::unavailable, source + ": OpenGL 4.5 is needed, this is " +
                                            glText(GL_VERSION) + " on " + glText(GL_RENDERER) +
                                            "; update the graphics driver, or set " +
                                            "LIBGL_ALWAYS_SOFTWARE=1 to draw with the CPU");
  }
  return GlContext(std::move(egl), std::move(source));
}

Result<GlContext> GlContext::createHeadless() {
  std::string tried;
  for (const EglPlatform& platform : eglPlatforms()) {
    auto egl = std::make_unique<EglContext>();
    std::string reason = egl->open(platform);
    if (reason.empty()) {
      auto context = checked(std::move(egl), platform.name);
      if (context) {
        return context;
      }
      reason = context.error().message;
    }
    tried += "\n  " + platform.name + ": " + reason;
  }
  if (tried.empty()) {
    tried = " EGL offers neither devices nor Mesa's surfaceless platform.";
  }
  return fail(ErrorCode::unavailable,
              "no way to draw without a display was found. Install libegl-mesa0 and "
              "libgl1-mesa-dri (drawing with the CPU) or the GPU's driver. Tried:" +
                  tried);
}

Result<GlContext> GlContext::adoptCurrent() {
  return checked(nullptr, "window");
}

std::string GlContext::description() const {
  return "OpenGL " + version_ + " on " + renderer_ + " (through " + source_ + ")";
}

bool currentContextIsSoftware() {
  const std::string renderer = glText(GL_RENDERER);
  bool software = false;
  for (const char* name : {"llvmpipe", "softpipe", "swrast", "SwiftShader", "Software"}) {
    software |= renderer.find(name) != std::string::npos;
  }
  return software;
}

std::string takeGlErrors() {
  std::string text;
  // Bounded: a lost context may report errors for ever.
  for (int i = 0; i < 16; ++i) {
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) {
      break;
    }
    text += text.empty() ? "" : ", ";
    switch (error) {
      case GL_INVALID_ENUM:
        text += "GL_INVALID_ENUM";
        break;
      case GL_INVALID_VALUE:
        text += "GL_INVALID_VALUE";
        break;
      case GL_INVALID_OPERATION:
        text += "GL_INVALID_OPERATION";
        break;
      case GL_INVALID_FRAMEBUFFER_OPERATION:
        text += "GL_INVALID_FRAMEBUFFER_OPERATION";
        break;
      case GL_OUT_OF_MEMORY:
        text += "GL_OUT_OF_MEMORY";
        break;
      default:
        text += "GL error " + std::to_string(error);
        break;
    }
  }
  return text;
}

}  // namespace meshfront
