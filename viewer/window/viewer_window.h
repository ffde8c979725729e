// A window on a scene: GLFW for the window, Dear ImGui for what lies over the picture. It opens at
// once and shows a message until there is a scene. The picture is drawn into a RenderTarget, as one
// does without a window, and copied to the screen.
//
//   auto window = ViewerWindow::open({.title = "bunny", .camera = spec});
//   WindowCallbacks callbacks;
//   callbacks.turn = [&] { ...take in what has arrived...; return SceneTurn{changed}; };
//   callbacks.draw = [&](const ViewToDraw& view) { ...draw into view.target, count, rank... };
//   callbacks.status = [&] { return panelStatus; };
//   window->setScene({bounds, hasColours});  // as soon as these are known, or when they change
//   auto end = window->run(callbacks);
//
// A turn of the loop: wait for events, `turn`, `draw` if anything in the picture has changed, put
// picture and panel on the screen if anything of these has changed, `turnEnd`. Waits are short
// while something moves or is at work, long else.
//
// One window a process, on the main thread; only wake() and stop() may be called from others.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "shared/camera/bounds.h"
#include "shared/camera/camera.h"
#include "shared/camera/camera_spec.h"
#include "shared/result.h"
#include "viewer/controls/input_event.h"
#include "viewer/controls/view_switches.h"
#include "viewer/gl/gl_context.h"
#include "viewer/gl/render_target.h"
#include "viewer/picture/picture.h"
#include "viewer/window/panel_status.h"

namespace meshfront {

struct WindowOptions {
  std::string title = "meshfront";
  PixelSize size{1280, 720};
  CameraSpec camera;
  ViewSwitches switches;
  double interfaceScale = 0;  // of letters and distances; 0: the display's
  // A person's input is ignored and only inject() acts: for scripts.
  bool scripted = false;
  double busyWait = 0.05;   // seconds between turns while something is at work
  double quietWait = 0.25;  // while nothing is
};

// What one looks at. The window's camera is placed by WindowOptions::camera when the scene is first
// set, and again when it changes before a person has moved it.
struct SceneView {
  Bounds bounds;
  bool hasColours = false;
  bool operator==(const SceneView& other) const {
    return bounds.min == other.bounds.min && bounds.max == other.bounds.max &&
           hasColours == other.hasColours;
  }
};

struct SceneTurn {
  bool changed = false;  // what the picture shows is not what was last drawn
  bool moving = false;   // it changes by time alone (geomorphs): the next turn comes at once
  bool busy = true;      // something is under way: turns come in short intervals
};

// To be drawn with Projection::fit(camera, bounds, target.size().aspect()), items and depth
// included: the window finds by them what is under the pointer.
struct ViewToDraw {
  RenderTarget& target;
  const Camera& camera;
  const Bounds& bounds;
  const ViewSwitches& switches;
  bool viewChanged;   // camera or size differ from the last picture's
  bool sceneChanged;  // SceneTurn::changed or moving
};

// A place where the picture shows the scene.
struct SurfacePlace {
  glm::dvec2 pixel{0};  // from the upper left
  glm::dvec3 world{0};
};

// Any may be empty.
struct WindowCallbacks {
  std::function<SceneTurn()> turn;
  // Called when the picture is out of date and there is a scene. An error ends run().
  std::function<Result<void>(const ViewToDraw&)> draw;
  // For the panel and the message; asked some ten times a second.
  std::function<PanelStatus()> status;
  // More of a point of the surface than its coordinates.
  std::function<PickedPoint(const SurfacePlace&)> pick;
  // Raise what is seen here; returns what to tell the person.
  std::function<std::string(const SurfacePlace&)> refineHere;
  // What a person should also find in the terminal, a line: the camera, a screenshot's name.
  std::function<void(const std::string&)> say;
  // At the end of each turn: readScreen(), inject(), status() and so on may be called.
  std::function<void()> turnEnd;
  // Says when to close, asked once a turn.
  std::function<bool()> finished;
};

class ViewerWindow {
 public:
  // Errors say what is missing (a display, a driver) and what to do about it; `invalid`: the
  // display lacks OpenGL 4.5.
  [[nodiscard]] static Result<ViewerWindow> open(const WindowOptions& options);
  ViewerWindow(ViewerWindow&&) noexcept;
  ViewerWindow& operator=(ViewerWindow&&) noexcept;
  ~ViewerWindow();

  // Until the window is closed, Q or Escape pressed, stop() called or finished() said so. The error
  // is of drawing.
  Result<void> run(const WindowCallbacks& callbacks);

  // From any thread: a turn of the loop now. Does nothing before open(); threads that call it must
  // have ended when the window is destroyed.
  static void wake();
  // From any thread or signal handler: ends run() at its next turn.
  static void stop();

  [[nodiscard]] const GlContext& context() const;
  void setScene(const SceneView& scene);
  [[nodiscard]] const std::optional<SceneView>& scene() const;
  void setTitle(const std::string& title);
  [[nodiscard]] const Camera& camera() const;
  void setCamera(const Camera& camera);
  [[nodiscard]] const ViewSwitches& switches() const;
  // Of the framebuffer, which differs from the window's on screens with scaling.
  [[nodiscard]] PixelSize pictureSize() const;
  // As a person resizing it would; takes effect in a later turn.
  void resize(PixelSize windowSize);
  // Goes the way that a person's input goes, panel included; drawn in the next turn.
  void inject(const InputEvent& event);
  // Everything that the panel can show, as of now.
  [[nodiscard]] PanelStatus status() const;
  // The picture as last drawn, without panel; empty while there is no scene.
  [[nodiscard]] std::optional<Picture> readView() const;
  // What the screen shows, panel included. None in a turn that puts nothing on the screen: the next
  // one will.
  [[nodiscard]] std::optional<Picture> readScreen();

 private:
  struct State;
  explicit ViewerWindow(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace meshfront
