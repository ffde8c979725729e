// Dear ImGui's set-up, sizes and input, so that what draws with it needs nothing of the window, and
// what feeds it nothing of ImGui. Everything is in pixels of the picture.
#pragma once

#include <array>

#include "shared/camera/camera.h"
#include "viewer/controls/input_event.h"

struct ImFont;

namespace meshfront {

class Gui {
 public:
  // The GL context must be current, and outlive it. `glslVersion`: "#version 450 core".
  // `scale`: of letters and distances, 1 on a screen of 96 dots an inch.
  Gui(const char* glslVersion, double scale);
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;
  ~Gui();

  void setScale(double scale);
  [[nodiscard]] double scale() const { return scale_; }

  void take(const InputEvent& event);
  // As of the last frame: the pointer is over a panel, and not the view's.
  [[nodiscard]] static bool takesPointer();

  // Draw between the two; end() paints into the current framebuffer.
  void begin(PixelSize picture, double seconds);
  static void end();

  // For what draws: pixels of `units` that are a 96th of an inch, and the font of headings.
  [[nodiscard]] static float pixels(double units);
  [[nodiscard]] static ImFont* headingFont();

 private:
  void makeFonts() const;

  double scale_;
  double lastFrame_ = 0;
  std::array<bool, 3> down_{};
  std::array<bool, 3> pressed_{};  // since the last frame: a quick click must not be lost
};

}  // namespace meshfront
