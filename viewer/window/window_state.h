// ViewerWindow's inside: what a turn of its loop does.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "viewer/controls/view_controls.h"
#include "viewer/window/frame_clock.h"
#include "viewer/window/glfw_window.h"
#include "viewer/window/gui.h"
#include "viewer/window/viewer_window.h"

namespace meshfront {

// Destroyed from the last member up: GL objects before their window.
struct ViewerWindow::State {
  GlfwWindow window;
  std::optional<GlContext> context;
  std::optional<RenderTarget> target;
  std::optional<Gui> gui;
  std::optional<ViewControls> controls;
  WindowOptions options;
  std::optional<SceneView> scene;
  Camera home;                                 // where the scene was first seen from
  const WindowCallbacks* callbacks = nullptr;  // while run() runs

  // What the picture shows; drawn again when any of it differs.
  std::optional<Camera> drawnCamera;
  PixelSize drawnSize;
  ViewSwitches drawnSwitches;
  bool pictureStale = true;

  // What the screen shows.
  PanelStatus shown;
  double shownAt = -1;    // seconds; when `shown` was asked for
  int turnsToShow = 0;    // the panel is drawn again in so many turns, whatever changes
  bool composed = false;  // in this turn
  bool screenAsked = false;

  FrameClock frames;
  uint64_t picturesDrawn = 0;
  std::vector<PickedPoint> picks;
  uint64_t picksMade = 0;
  std::string note;
  double noteUntil = 0;

  void start();
  void take(const InputEvent& event);
  Result<double> turn();  // seconds that the next turn may be away
  [[nodiscard]] PanelStatus statusNow() const;
  void placeScene(const SceneView& wanted);

 private:
  Result<bool> drawPicture(const SceneTurn& turned);
  bool compose(bool drawn);
  void paint();
  void carryOut(const ViewCommand& command);
  void pick(const SurfacePlace& place, bool fromFirst);
  void saveScreenshot();
  void copyCamera();
  void say(const std::string& text, bool inTerminal);
  [[nodiscard]] std::optional<SurfacePlace> surfaceAt(glm::dvec2 place) const;
};

}  // namespace meshfront
