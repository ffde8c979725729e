#include "viewer/window/message_window.h"

#include <epoxy/gl.h>

#include "viewer/window/glfw_window.h"
#include "viewer/window/gui.h"
#include "viewer/window/overlays.h"

namespace meshfront {

Result<void> showMessageWindow(const std::string& title, const WindowMessage& message,
                               const std::function<bool()>& finished) {
  constexpr PixelSize kSize{720, 400};
  GlfwWindow window;
  if (auto opened = window.open(title, kSize, {3, 0, false}); !opened) return opened;
  Gui gui("#version 130", window.contentScale());
  bool ended = false;
  window.onInput = [&ended](const InputEvent& event) {
    ended = ended || std::holds_alternative<KeyPressed>(event);
  };
  while (!ended && !window.closeAsked() && !finished()) {
    const PixelSize size = window.pictureSize();
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, size.width, size.height);
    glDisable(GL_SCISSOR_TEST);
    glClearColor(0.90F, 0.905F, 0.915F, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    gui.begin(size, GlfwWindow::seconds());
    drawMessage(message, size, true);
    Gui::end();
    window.swap();
    GlfwWindow::wait(0.1);
  }
  return {};
}

}  // namespace meshfront
