// A window on a mesh: GLFW for the window, Dear ImGui for the panel. It draws into a RenderTarget
// as one does without a window, and copies that to the screen.
//
//   auto window = ViewerWindow::open({.title = "bunny", .camera = spec, .bounds = bounds});
//   WindowCallbacks callbacks;
//   callbacks.mesh = [&] { receiver.applyAnswers(); return arraysOf(mesh); };
//   callbacks.drawn = [&](const DrawnView& view) { if (view.viewChanged) ...count and rank... };
//   callbacks.status = [&] { return std::vector<std::string>{"records 1,234 of 5,678"}; };
//   auto end = window->run(callbacks);
//
// One window a process, on the main thread; only wake() and stop() may be called from others.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "shared/camera/bounds.h"
#include "shared/camera/camera.h"
#include "shared/camera/camera_spec.h"
#include "shared/result.h"
#include "viewer/gl/gl_context.h"
#include "viewer/gl/gpu_mesh.h"
#include "viewer/gl/mesh_renderer.h"
#include "viewer/gl/render_target.h"

namespace meshfront {

struct WindowOptions {
  std::string title = "meshfront";
  PixelSize size{1280, 720};
  CameraSpec camera;
  Bounds bounds;  // of the whole mesh, world
  DrawStyle style;
  // A turn of the loop without input or wake() comes at least this often, seconds.
  double idleWait = 0.05;
};

// What is on the screen; valid during the call, with the window's GL context current. The target
// holds the picture and the items: a PixelCounter may count them.
struct DrawnView {
  const RenderTarget& target;
  const GpuMesh& mesh;
  const Camera& camera;
  bool viewChanged;  // camera or size differ from the last call
  bool meshChanged;  // the mesh was uploaded since the last call
};

// Any may be empty, except mesh.
struct WindowCallbacks {
  // Called once a turn of the loop, before drawing: apply what has arrived and say what to draw.
  // The spans must stay valid until the next callback. Uploaded only when changeCount differs.
  std::function<MeshArrays()> mesh;
  // After each picture that differs from the last one.
  std::function<void(const DrawnView&)> drawn;
  // Lines for the panel, once a turn; a line with a tab is shown as name and value.
  std::function<std::vector<std::string>()> status;
  // Once a turn, when the screen's next content is complete: readScreen() may be called.
  std::function<void()> composed;
  // Says when to close, asked once a turn, after drawing.
  std::function<bool()> finished;
};

class ViewerWindow {
 public:
  // Errors say what is missing (a display, a driver) and what to do about it.
  [[nodiscard]] static Result<ViewerWindow> open(const WindowOptions& options);
  ViewerWindow(ViewerWindow&&) noexcept;
  ViewerWindow& operator=(ViewerWindow&&) noexcept;
  ~ViewerWindow();

  // Until the window is closed, Q or Escape pressed, stop() called or finished() said so. The error
  // is of drawing: no GPU memory, corners out of range.
  Result<void> run(const WindowCallbacks& callbacks);

  // From any thread: a turn of the loop now. Does nothing before open(); threads that call it must
  // have ended when the window is destroyed.
  static void wake();
  // From any thread or signal handler: ends run() at its next turn.
  static void stop();

  [[nodiscard]] const GlContext& context() const;
  [[nodiscard]] const Camera& camera() const;
  // Of the framebuffer, which differs from the window's on screens with scaling.
  [[nodiscard]] PixelSize pictureSize() const;
  // As a person resizing it would; takes effect in a later turn.
  void resize(PixelSize windowSize);
  // What the screen is about to show, panel included. In the `composed` callback only.
  [[nodiscard]] Picture readScreen() const;

 private:
  struct State;
  explicit ViewerWindow(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace meshfront
