// A GLFW window with an OpenGL context, and its events as InputEvents. Owns the library with it:
// one a process, on the main thread.
#pragma once

#include <functional>
#include <string>

#include "shared/camera/camera.h"
#include "shared/result.h"
#include "viewer/controls/input_event.h"

struct GLFWwindow;

namespace meshfront {

struct GlVersion {
  int major = 4;
  int minor = 5;
  bool core = true;
};

class GlfwWindow {
 public:
  GlfwWindow() = default;
  GlfwWindow(const GlfwWindow&) = delete;
  GlfwWindow& operator=(const GlfwWindow&) = delete;
  ~GlfwWindow();

  // With its context current. The error says what is missing and what to do; its code is
  // `unavailable` where there is no display, `invalid` where the display lacks this OpenGL.
  Result<void> open(const std::string& title, PixelSize size, GlVersion version);

  // Set before the first events are waited for; empty ones are not called.
  std::function<void(const InputEvent&)> onInput;
  std::function<void()> onExposed;  // contents must be shown again
  std::function<void()> onFocusLost;
  std::function<void(double)> onScale;  // the content scale has changed

  // Waits for events, at most `seconds`; 0: takes what is there.
  static void wait(double seconds);
  [[nodiscard]] bool closeAsked() const;
  [[nodiscard]] PixelSize pictureSize() const;  // of the framebuffer
  [[nodiscard]] double contentScale() const;    // 1 on a screen of 96 dots an inch
  [[nodiscard]] static double seconds();        // a steady clock
  void resize(PixelSize size);
  void setTitle(const std::string& title);
  void copy(const std::string& text);  // to the clipboard
  void swap();

  // From any thread; does nothing while no window is open.
  static void wake();
  [[nodiscard]] static bool isOpen();

 private:
  void installCallbacks();
  [[nodiscard]] glm::dvec2 inPicture(double x, double y) const;
  GLFWwindow* handle_ = nullptr;
};

}  // namespace meshfront
