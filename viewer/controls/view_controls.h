// What pointer, wheel and keys do to a view, apart from any window system: the window feeds it,
// scripts and tests too.
//
//   ViewControls controls(camera, bounds);
//   controls.setSurfaceProbe([&](glm::dvec2 place) { return worldPointAt(place); });
//   controls.handle(event, picture, now);
//   for (const ViewCommand& command : controls.takeCommands()) ...carry it out...
//
// kControlLines (control_lines.h) lists for people what does what.
#pragma once

#include <functional>
#include <glm/vec2.hpp>
#include <optional>
#include <vector>

#include "shared/camera/bounds.h"
#include "shared/camera/camera.h"
#include "viewer/controls/input_event.h"
#include "viewer/controls/view_switches.h"

namespace meshfront {

// What the controls cannot do themselves.
struct ViewCommand {
  enum class Kind : uint8_t {
    pick,        // the point at `place`; the distance is to the point picked before
    measure,     // the same, but the point picked first stays
    clearPicks,  // forgets the picked points
    refineHere,  // raise what is seen at `place`
    screenshot,  // the view without the panel, to a numbered file
    copyCamera,  // as an option string to the clipboard
  };
  Kind kind = Kind::pick;
  glm::dvec2 place{0};  // where the pointer was

  bool operator==(const ViewCommand&) const = default;
};

class ViewControls {
 public:
  ViewControls(const Camera& start, const Bounds& bounds)
      : camera_(start), start_(start), bounds_(bounds) {}

  // The world point seen at a place of the picture as `camera()` shows it; none where it shows
  // none, or where that is not known at the moment.
  using SurfaceProbe = std::function<std::optional<glm::dvec3>(glm::dvec2 place)>;
  void setSurfaceProbe(SurfaceProbe probe) { probe_ = std::move(probe); }

  // `seconds`: any steady clock's. Places are pixels of `picture`.
  void handle(const InputEvent& event, PixelSize picture, double seconds);
  // Lets go of a drag: the pointer has been taken away (focus lost, the panel has it).
  void cancelDrag() { drag_ = Drag::none; }

  [[nodiscard]] const Camera& camera() const { return camera_; }
  [[nodiscard]] const Bounds& bounds() const { return bounds_; }
  [[nodiscard]] const ViewSwitches& switches() const { return switches_; }
  [[nodiscard]] ViewSwitches& switches() { return switches_; }
  [[nodiscard]] bool quitAsked() const { return quitAsked_; }

  void setCamera(const Camera& camera);
  // What reset() goes back to and fit() shows, when that becomes known or changes.
  void setHome(const Camera& start, const Bounds& bounds);
  // Whether own colours and clay differ, for the cycle of colourings.
  void setHasColours(bool has) { hasColours_ = has; }
  // What a pixel of the screen is to distances of clicks: the content scale.
  void setPixelScale(double scale) { pixelScale_ = scale; }

  void fit(PixelSize picture);
  void reset() { setCamera(start_); }
  void quit() { quitAsked_ = true; }
  void nextColouring(bool backward);
  void ask(ViewCommand::Kind kind) { commands_.push_back({kind, pointer_}); }

  // In the order in which they came; each once.
  [[nodiscard]] std::vector<ViewCommand> takeCommands();

 private:
  enum class Drag : uint8_t { none, waiting, orbit, pan, roll };

  void press(const PointerPressed& event, double seconds);
  void release(const PointerReleased& event, double seconds);
  void move(glm::dvec2 place, PixelSize picture);
  void scroll(double steps, PixelSize picture);
  void key(const KeyPressed& event, PixelSize picture);
  void letter(char upperCase, Modifiers modifiers, PixelSize picture);
  void arrow(Key key, bool panning, PixelSize picture);
  void zoom(const glm::dvec3& point, double steps);
  void recentre(const glm::dvec3& point);
  [[nodiscard]] std::optional<glm::dvec3> surfaceAt(glm::dvec2 place) const;
  [[nodiscard]] double distanceAlongView(const glm::dvec3& point) const;

  Camera camera_;
  Camera start_;
  Bounds bounds_;
  SurfaceProbe probe_;
  ViewSwitches switches_;
  bool hasColours_ = true;
  bool quitAsked_ = false;
  double pixelScale_ = 1;
  std::vector<ViewCommand> commands_;

  glm::dvec2 pointer_{0};
  Drag drag_ = Drag::none;  // waiting: pressed, and not yet moved as far as a drag
  Drag dragKind_ = Drag::none;
  PointerButton dragButton_ = PointerButton::left;
  glm::dvec2 pressedAt_{0};
  std::optional<double> grabbedDistance_;  // of what the pointer took hold of, along the view
  std::optional<double> clickedWhen_;      // the last click's end, seconds
  glm::dvec2 clickedAt_{0};
  bool doubleClick_ = false;
  // What the wheel goes to while the pointer rests: it stays under the pointer.
  std::optional<glm::dvec3> zoomPoint_;
};

}  // namespace meshfront
