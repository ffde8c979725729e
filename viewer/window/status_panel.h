// The panel over the picture: status lines of the application, switches, help. Dear ImGui's set-up
// is here too, so that no other file needs its headers.
#pragma once

#include <string>
#include <vector>

#include "viewer/controls/view_controls.h"

struct GLFWwindow;

namespace meshfront {

class StatusPanel {
 public:
  // Installs input callbacks that go on to those set before. The context must be current.
  explicit StatusPanel(GLFWwindow* window);
  StatusPanel(const StatusPanel&) = delete;
  StatusPanel& operator=(const StatusPanel&) = delete;
  ~StatusPanel();

  // The pointer or the keys are the panel's now, not the view's.
  [[nodiscard]] static bool takesPointer();
  [[nodiscard]] static bool takesKeys();
  // Draws into the current framebuffer; switches act on the controls.
  static void draw(const std::vector<std::string>& lines, ViewControls& controls,
                   PixelSize picture);
};

}  // namespace meshfront
