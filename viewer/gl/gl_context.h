// An OpenGL 4.5 core context: made without any display (EGL), or adopted from a window.
//
//   auto context = GlContext::createHeadless();
//   if (!context) { std::cerr << context.error().message; return 1; }
//   std::cout << context->description();
//
// Current on the thread that made it and used there only. Whatever was made with it must be
// destroyed before it.
#pragma once

#include <memory>
#include <string>

#include "shared/result.h"

namespace meshfront {

class EglContext;

class GlContext {
 public:
  // Tries the machine's GPUs one after the other (EGL devices), then Mesa without a device, then
  // Mesa's software device. The error lists what was tried and why each failed.
  [[nodiscard]] static Result<GlContext> createHeadless();
  // The context that a window has made current; the window keeps owning it.
  [[nodiscard]] static Result<GlContext> adoptCurrent();

  GlContext(GlContext&&) noexcept;
  GlContext& operator=(GlContext&&) noexcept;
  ~GlContext();

  [[nodiscard]] const std::string& renderer() const { return renderer_; }
  [[nodiscard]] const std::string& version() const { return version_; }
  // Drawn by the CPU (llvmpipe and its like).
  [[nodiscard]] bool isSoftware() const { return software_; }
  // "OpenGL 4.5 ... on ... (through ...)".
  [[nodiscard]] std::string description() const;

 private:
  explicit GlContext(std::unique_ptr<EglContext> egl, std::string source);
  [[nodiscard]] static Result<GlContext> checked(std::unique_ptr<EglContext> egl,
                                                 std::string source);

  std::unique_ptr<EglContext> egl_;  // null when adopted
  std::string source_;
  std::string renderer_;
  std::string version_;
  bool software_ = false;
};

// Whether the current context draws with the CPU.
[[nodiscard]] bool currentContextIsSoftware();

// The errors pending in the current context ("GL_INVALID_OPERATION, ..."); empty when there is
// none. Clears them. For tests and for the end of large steps.
[[nodiscard]] std::string takeGlErrors();

}  // namespace meshfront
