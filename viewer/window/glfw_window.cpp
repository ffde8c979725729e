#include "viewer/window/glfw_window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <optional>
#include <utility>

namespace meshfront {
namespace {

std::atomic<bool> windowIsOpen{false};  // what other threads may look at

std::string glfwErrorText() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text == nullptr ? "no reason given" : text;
}

GLFWwindow* createHandle(const std::string& title, PixelSize size, GlVersion version, int api) {
  glfwDefaultWindowHints();
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, version.major);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, version.minor);
  if (version.core) glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_CONTEXT_CREATION_API, api);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  glfwWindowHint(GLFW_SAMPLES, 0);
  return glfwCreateWindow(size.width, size.height, title.c_str(), nullptr, nullptr);
}

GlfwWindow& windowOf(GLFWwindow* handle) {
  return *static_cast<GlfwWindow*>(glfwGetWindowUserPointer(handle));
}

void report(GLFWwindow* handle, const InputEvent& event) {
  const GlfwWindow& window = windowOf(handle);
  if (window.onInput) window.onInput(event);
}

Modifiers modifiersOf(int mods) {
  return {(mods & GLFW_MOD_SHIFT) != 0, (mods & GLFW_MOD_CONTROL) != 0, (mods & GLFW_MOD_ALT) != 0};
}

std::optional<PointerButton> buttonOf(int button) {
  switch (button) {
    case GLFW_MOUSE_BUTTON_LEFT:
      return PointerButton::left;
    case GLFW_MOUSE_BUTTON_MIDDLE:
      return PointerButton::middle;
    case GLFW_MOUSE_BUTTON_RIGHT:
      return PointerButton::right;
    default:
      return std::nullopt;
  }
}

constexpr std::array kNamedCodes{
    std::pair(GLFW_KEY_LEFT, Key::left), std::pair(GLFW_KEY_RIGHT, Key::right),
    std::pair(GLFW_KEY_UP, Key::up),     std::pair(GLFW_KEY_DOWN, Key::down),
    std::pair(GLFW_KEY_HOME, Key::home), std::pair(GLFW_KEY_ESCAPE, Key::escape),
    std::pair(GLFW_KEY_TAB, Key::tab),   std::pair(GLFW_KEY_DELETE, Key::deleteKey),
    std::pair(GLFW_KEY_F1, Key::f1),     std::pair(GLFW_KEY_F12, Key::f12)};

// Letters as they are printed on this keyboard; + - ? [ ] come as characters instead.
Key keyOf(int key, int scancode) {
  for (const auto& [code, named] : kNamedCodes)
    if (code == key) return named;
  const char* printed = glfwGetKeyName(key, scancode);
  const char letter = printed != nullptr && printed[1] == '\0' ? printed[0] : '\0';
  if (letter >= 'a' && letter <= 'z') return letterKey(static_cast<char>(letter - 'a' + 'A'));
  const bool latin = letter != '\0';  // else a script without these letters: by their place
  return !latin && key >= GLFW_KEY_A && key <= GLFW_KEY_Z ? letterKey(static_cast<char>(key))
                                                          : Key::none;
}

// Held keys move on, but do not switch to and fro.
bool repeats(Key key) {
  return key == Key::left || key == Key::right || key == Key::up || key == Key::down;
}

}  // namespace

GlfwWindow::~GlfwWindow() {
  if (handle_ == nullptr) return;
  windowIsOpen = false;
  glfwDestroyWindow(handle_);
  glfwTerminate();
}

Result<void> GlfwWindow::open(const std::string& title, PixelSize size, GlVersion version) {
  if (windowIsOpen || handle_ != nullptr) {
    return fail("a window is open already");
  }
  glfwSetErrorCallback(nullptr);
  if (glfwInit() != GLFW_TRUE) {
    return fail(ErrorCode::unavailable,
                "no window can be opened: " + glfwErrorText() +
                    ". Run it on a desktop, or use --headless, or xvfb-run -a");
  }
  std::string reasons;
  // The native way to a context first (GLX under X11), then EGL.
  for (const int api : {GLFW_NATIVE_CONTEXT_API, GLFW_EGL_CONTEXT_API}) {
    handle_ = createHandle(title, size, version, api);
    if (handle_ != nullptr) break;
    reasons += (reasons.empty() ? "" : "; ") + glfwErrorText();
  }
  if (handle_ == nullptr) {
    glfwTerminate();
    return fail(ErrorCode::invalid, "no window with OpenGL " + std::to_string(version.major) + "." +
                                        std::to_string(version.minor) +
                                        " can be opened: " + reasons +
                                        ". Update the graphics driver, or set "
                                        "LIBGL_ALWAYS_SOFTWARE=1, or use --headless");
  }
  windowIsOpen = true;
  glfwMakeContextCurrent(handle_);
  glfwSwapInterval(1);
  installCallbacks();
  return {};
}

void GlfwWindow::installCallbacks() {
  glfwSetWindowUserPointer(handle_, this);
  glfwSetCursorPosCallback(handle_, [](GLFWwindow* w, double x, double y) {
    report(w, PointerMoved{windowOf(w).inPicture(x, y)});
  });
  glfwSetMouseButtonCallback(handle_, [](GLFWwindow* w, int button, int action, int mods) {
    const auto which = buttonOf(button);
    if (!which) return;
    if (action == GLFW_RELEASE) {
      report(w, PointerReleased{*which, modifiersOf(mods)});
    } else {
      report(w, PointerPressed{*which, modifiersOf(mods)});
    }
  });
  glfwSetScrollCallback(handle_, [](GLFWwindow* w, double x, double y) {
    report(w, Scrolled{{x, y}});
  });
  glfwSetKeyCallback(handle_, [](GLFWwindow* w, int code, int scancode, int action, int mods) {
    const Key key = keyOf(code, scancode);
    if (key == Key::none || action == GLFW_RELEASE) return;
    if (action == GLFW_REPEAT && !repeats(key)) return;
    report(w, KeyPressed{key, modifiersOf(mods)});
  });
  glfwSetCharCallback(handle_, [](GLFWwindow* w, unsigned character) {
    switch (character) {
      case '+':
      case '=':  // the same key without Shift on many keyboards
        report(w, KeyPressed{Key::plus, {}});
        break;
      case '-':
      case '?':
      case '[':
      case ']':
        report(w, KeyPressed{static_cast<Key>(character), {}});
        break;
      default:
        break;
    }
  });
  glfwSetWindowRefreshCallback(handle_, [](GLFWwindow* w) {
    if (windowOf(w).onExposed) windowOf(w).onExposed();
  });
  glfwSetWindowFocusCallback(handle_, [](GLFWwindow* w, int focused) {
    if (focused == GLFW_FALSE && windowOf(w).onFocusLost) windowOf(w).onFocusLost();
  });
  glfwSetWindowContentScaleCallback(handle_, [](GLFWwindow* w, float, float) {
    if (windowOf(w).onScale) windowOf(w).onScale(windowOf(w).contentScale());
  });
}

glm::dvec2 GlfwWindow::inPicture(double x, double y) const {
  int width = 0;
  int height = 0;
  glfwGetWindowSize(handle_, &width, &height);
  const PixelSize picture = pictureSize();
  return {x * picture.width / std::max(1, width), y * picture.height / std::max(1, height)};
}

void GlfwWindow::wait(double seconds) {
  if (seconds > 0) {
    glfwWaitEventsTimeout(seconds);
  } else {
    glfwPollEvents();
  }
}

bool GlfwWindow::closeAsked() const {
  return glfwWindowShouldClose(handle_) == GLFW_TRUE;
}

PixelSize GlfwWindow::pictureSize() const {
  PixelSize size;
  glfwGetFramebufferSize(handle_, &size.width, &size.height);
  return size;
}

double GlfwWindow::contentScale() const {
  float x = 1;
  float y = 1;
  glfwGetWindowContentScale(handle_, &x, &y);
  return std::clamp(static_cast<double>(std::max(x, y)), 0.5, 4.0);
}

double GlfwWindow::seconds() {
  return glfwGetTime();
}

void GlfwWindow::resize(PixelSize size) {
  glfwSetWindowSize(handle_, size.width, size.height);
}

void GlfwWindow::setTitle(const std::string& title) {
  glfwSetWindowTitle(handle_, title.c_str());
}

void GlfwWindow::copy(const std::string& text) {
  glfwSetClipboardString(handle_, text.c_str());
}

void GlfwWindow::swap() {
  glfwSwapBuffers(handle_);
}

void GlfwWindow::wake() {
  if (windowIsOpen) glfwPostEmptyEvent();
}

bool GlfwWindow::isOpen() {
  return windowIsOpen;
}

}  // namespace meshfront
