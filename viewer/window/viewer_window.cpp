#include "viewer/window/viewer_window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <utility>

#include "viewer/controls/view_controls.h"
#include "viewer/window/status_panel.h"

namespace meshfront {
namespace {

// What other threads may touch.
std::atomic<bool> windowIsOpen{false};
std::atomic<bool> stopAsked{false};

std::string glfwErrorText() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text == nullptr ? "no reason given" : text;
}

PixelSize framebufferSize(GLFWwindow* window) {
  PixelSize size;
  glfwGetFramebufferSize(window, &size.width, &size.height);
  return size;
}

// The native way to a context first (GLX under X11), then EGL.
GLFWwindow* createWindow(const WindowOptions& options, std::string& reason) {
  for (const int api : {GLFW_NATIVE_CONTEXT_API, GLFW_EGL_CONTEXT_API}) {
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_CONTEXT_CREATION_API, api);
    glfwWindowHint(GLFW_DEPTH_BITS, 0);
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    glfwWindowHint(GLFW_SAMPLES, 0);
    GLFWwindow* window = glfwCreateWindow(options.size.width, options.size.height,
                                          options.title.c_str(), nullptr, nullptr);
    if (window != nullptr) {
      return window;
    }
    reason += (reason.empty() ? "" : "; ") + glfwErrorText();
  }
  return nullptr;
}

// Owns the window, and the library with it.
struct GlfwWindow {
  GLFWwindow* handle = nullptr;
  GlfwWindow() = default;
  GlfwWindow(const GlfwWindow&) = delete;
  GlfwWindow& operator=(const GlfwWindow&) = delete;
  ~GlfwWindow() {
    windowIsOpen = false;
    if (handle != nullptr) {
      glfwDestroyWindow(handle);
    }
    glfwTerminate();
  }
};

}  // namespace

// Destroyed from the last member up: GL objects before their window.
struct ViewerWindow::State {
  GlfwWindow window;
  std::optional<GlContext> context;
  std::optional<MeshRenderer> renderer;
  std::optional<RenderTarget> target;
  std::optional<GpuMesh> mesh;
  std::optional<StatusPanel> panel;
  std::optional<ViewControls> controls;
  WindowOptions options;

  // What the picture shows; drawn again when any of it differs.
  std::optional<Camera> drawnCamera;
  PixelSize drawnSize;
  DrawStyle drawnStyle;

  void installCallbacks();
  Result<void> turn(const WindowCallbacks& callbacks);
  void show(const WindowCallbacks& callbacks);
  [[nodiscard]] glm::dvec2 cursorInPicture() const;
  [[nodiscard]] PixelSize size() const { return framebufferSize(window.handle); }
};

namespace {

// GLFW's callbacks come with the window alone; its user pointer leads to the state.
template <typename State>
State& stateOf(GLFWwindow* window) {
  return *static_cast<State*>(glfwGetWindowUserPointer(window));
}

std::optional<PointerButton> pointerButton(int button) {
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

}  // namespace

glm::dvec2 ViewerWindow::State::cursorInPicture() const {
  glm::dvec2 cursor(0);
  glfwGetCursorPos(window.handle, &cursor.x, &cursor.y);
  int width = 0;
  int height = 0;
  glfwGetWindowSize(window.handle, &width, &height);
  const PixelSize picture = size();
  return {cursor.x * picture.width / std::max(1, width),
          cursor.y * picture.height / std::max(1, height)};
}

void ViewerWindow::State::installCallbacks() {
  glfwSetWindowUserPointer(window.handle, this);
  glfwSetMouseButtonCallback(window.handle, [](GLFWwindow* w, int button, int action, int mods) {
    auto& state = stateOf<State>(w);
    const auto which = pointerButton(button);
    if (!which) {
      return;
    }
    if (action == GLFW_RELEASE) {
      state.controls->release(*which);
    } else if (!StatusPanel::takesPointer()) {
      state.controls->press(*which, (mods & GLFW_MOD_SHIFT) != 0, state.cursorInPicture());
    }
  });
  glfwSetCursorPosCallback(window.handle, [](GLFWwindow* w, double, double) {
    auto& state = stateOf<State>(w);
    state.controls->move(state.cursorInPicture(), state.size());
  });
  glfwSetScrollCallback(window.handle, [](GLFWwindow* w, double, double steps) {
    auto& state = stateOf<State>(w);
    if (StatusPanel::takesPointer()) {
      return;
    }
    const glm::dvec2 cursor = state.cursorInPicture();
    // The depth on the screen is of the drawn camera: good for the first of several steps only.
    std::optional<float> depth;
    if (state.drawnCamera == state.controls->camera() && state.drawnSize == state.size()) {
      depth = state.target->depthAt(static_cast<int>(cursor.x), static_cast<int>(cursor.y));
    }
    state.controls->scroll(steps, cursor, state.size(), depth);
  });
  glfwSetKeyCallback(window.handle, [](GLFWwindow* w, int key, int, int action, int) {
    auto& state = stateOf<State>(w);
    if (action != GLFW_PRESS || StatusPanel::takesKeys()) {
      return;
    }
    if (key == GLFW_KEY_ESCAPE) {
      state.controls->key('Q', state.size());
    } else if (key >= GLFW_KEY_A && key <= GLFW_KEY_Z) {
      state.controls->key(static_cast<char>(key), state.size());
    }
  });
}

Result<void> ViewerWindow::State::turn(const WindowCallbacks& callbacks) {
  const PixelSize picture = size();
  if (picture.width < 1 || picture.height < 1) {
    return {};  // minimised
  }
  if (auto resized = target->resize(picture); !resized) {
    return resized;
  }
  const auto uploaded = mesh->update(callbacks.mesh());
  if (!uploaded) {
    return tl::unexpected(uploaded.error());
  }
  DrawStyle style = options.style;
  style.flatShading = controls->flatShading();
  style.wireframe = controls->wireframe();
  style.colours = controls->colours();
  const bool viewChanged = drawnCamera != controls->camera() || drawnSize != picture;
  if (viewChanged || *uploaded || style != drawnStyle) {
    renderer->draw(*target, *mesh, controls->camera(), options.bounds, style);
    drawnCamera = controls->camera();
    drawnSize = picture;
    drawnStyle = style;
    if (callbacks.drawn) {
      callbacks.drawn({*target, *mesh, *drawnCamera, viewChanged, *uploaded});
    }
  }
  show(callbacks);
  return {};
}

void ViewerWindow::State::show(const WindowCallbacks& callbacks) {
  target->blitToWindow(drawnSize);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, drawnSize.width, drawnSize.height);
  StatusPanel::draw(callbacks.status ? callbacks.status() : std::vector<std::string>{}, *controls,
                    drawnSize);
  if (callbacks.composed) {
    callbacks.composed();
  }
  glfwSwapBuffers(window.handle);
}

Result<ViewerWindow> ViewerWindow::open(const WindowOptions& options) {
  if (windowIsOpen) {
    return fail("a window is open already");
  }
  glfwSetErrorCallback(nullptr);
  auto state = std::make_unique<State>();
  state->options = options;
  if (glfwInit() != GLFW_TRUE) {
    return fail(ErrorCode::unavailable,
                "no window can be opened: " + glfwErrorText() +
                    ". Run it on a desktop, or use --headless, or xvfb-run -a");
  }
  std::string reason;
  state->window.handle = createWindow(options, reason);
  if (state->window.handle == nullptr) {
    return fail(ErrorCode::unavailable,
                "no window with OpenGL 4.5 can be opened: " + reason +
                    ". Update the graphics driver, or set LIBGL_ALWAYS_SOFTWARE=1, or use "
                    "--headless");
  }
  windowIsOpen = true;
  stopAsked = false;
  glfwMakeContextCurrent(state->window.handle);
  glfwSwapInterval(1);
  auto context = GlContext::adoptCurrent();
  if (!context) {
    return tl::unexpected(context.error());
  }
  state->context.emplace(std::move(*context));
  auto renderer = MeshRenderer::create();
  if (!renderer) {
    return tl::unexpected(renderer.error());
  }
  state->renderer.emplace(std::move(*renderer));
  auto target = RenderTarget::create(state->size());
  if (!target) {
    return tl::unexpected(target.error());
  }
  state->target.emplace(std::move(*target));
  state->mesh.emplace();
  state->controls.emplace(placeCamera(options.camera, options.bounds, state->size().aspect()),
                          options.bounds);
  state->controls->setFlatShading(options.style.flatShading);
  state->controls->setWireframe(options.style.wireframe);
  state->controls->setColours(options.style.colours);
  state->installCallbacks();
  state->panel.emplace(state->window.handle);  // its callbacks go on to ours
  return ViewerWindow(std::move(state));
}

Result<void> ViewerWindow::run(const WindowCallbacks& callbacks) {
  GLFWwindow* window = state_->window.handle;
  while (glfwWindowShouldClose(window) == GLFW_FALSE && !state_->controls->quitAsked() &&
         !stopAsked) {
    glfwWaitEventsTimeout(state_->options.idleWait);
    if (auto turned = state_->turn(callbacks); !turned) {
      return turned;
    }
    if (callbacks.finished && callbacks.finished()) {
      break;
    }
  }
  return {};
}

void ViewerWindow::wake() {
  if (windowIsOpen) {
    glfwPostEmptyEvent();
  }
}

void ViewerWindow::stop() {
  stopAsked = true;
}

ViewerWindow::ViewerWindow(std::unique_ptr<State> state) : state_(std::move(state)) {}
ViewerWindow::ViewerWindow(ViewerWindow&&) noexcept = default;
ViewerWindow& ViewerWindow::operator=(ViewerWindow&&) noexcept = default;
ViewerWindow::~ViewerWindow() = default;

const GlContext& ViewerWindow::context() const {
  return *state_->context;
}

const Camera& ViewerWindow::camera() const {
  return state_->controls->camera();
}

PixelSize ViewerWindow::pictureSize() const {
  return state_->size();
}

void ViewerWindow::resize(PixelSize windowSize) {
  glfwSetWindowSize(state_->window.handle, windowSize.width, windowSize.height);
}

Picture ViewerWindow::readScreen() const {
  const PixelSize size = state_->drawnSize;
  Picture picture{size.width, size.height, {}};
  const auto width = static_cast<size_t>(size.width);
  picture.rgb.resize(3 * width * static_cast<size_t>(size.height));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
  glReadBuffer(GL_BACK);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  for (int y = 0; y < size.height; ++y) {
    glReadPixels(0, size.height - 1 - y, size.width, 1, GL_RGB, GL_UNSIGNED_BYTE,
                 picture.rgb.data() + 3 * width * static_cast<size_t>(y));
  }
  return picture;
}

}  // namespace meshfront
