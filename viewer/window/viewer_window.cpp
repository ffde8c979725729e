#include "viewer/window/viewer_window.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <atomic>
#include <utility>

#include "viewer/window/window_state.h"

namespace meshfront {
namespace {

std::atomic<bool> stopAsked{false};  // what other threads may touch

}  // namespace

Result<ViewerWindow> ViewerWindow::open(const WindowOptions& options) {
  auto state = std::make_unique<State>();
  state->options = options;
  if (auto opened = state->window.open(options.title, options.size, {4, 5, true}); !opened) {
    return tl::unexpected(opened.error());
  }
  stopAsked = false;
  auto context = GlContext::adoptCurrent();
  if (!context) return tl::unexpected(context.error());
  state->context.emplace(std::move(*context));
  const PixelSize size = state->window.pictureSize();
  auto target = RenderTarget::create({std::max(1, size.width), std::max(1, size.height)});
  if (!target) return tl::unexpected(target.error());
  state->target.emplace(std::move(*target));
  const double scale =
      options.interfaceScale > 0 ? options.interfaceScale : state->window.contentScale();
  state->gui.emplace("#version 450 core", scale);
  state->controls.emplace(placeCamera(options.camera, {}, size.aspect()), Bounds{});
  state->controls->switches() = options.switches;
  state->controls->setPixelScale(scale);
  state->start();
  return ViewerWindow(std::move(state));
}

Result<void> ViewerWindow::run(const WindowCallbacks& callbacks) {
  State& state = *state_;
  state.callbacks = &callbacks;
  double wait = 0;
  Result<void> outcome;
  while (true) {
    GlfwWindow::wait(wait);
    if (state.window.closeAsked() || state.controls->quitAsked() || stopAsked) break;
    const Result<double> turned = state.turn();
    if (!turned) {
      outcome = tl::unexpected(turned.error());
      break;
    }
    wait = *turned;
    if (callbacks.finished && callbacks.finished()) break;
  }
  state.callbacks = nullptr;
  return outcome;
}

void ViewerWindow::wake() {
  GlfwWindow::wake();
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

void ViewerWindow::setScene(const SceneView& scene) {
  state_->placeScene(scene);
}

const std::optional<SceneView>& ViewerWindow::scene() const {
  return state_->scene;
}

void ViewerWindow::setTitle(const std::string& title) {
  state_->window.setTitle(title);
}

const Camera& ViewerWindow::camera() const {
  return state_->controls->camera();
}

void ViewerWindow::setCamera(const Camera& camera) {
  state_->controls->setCamera(camera);
}

const ViewSwitches& ViewerWindow::switches() const {
  return state_->controls->switches();
}

PixelSize ViewerWindow::pictureSize() const {
  return state_->window.pictureSize();
}

void ViewerWindow::resize(PixelSize windowSize) {
  state_->window.resize(windowSize);
}

void ViewerWindow::inject(const InputEvent& event) {
  state_->take(event);
}

PanelStatus ViewerWindow::status() const {
  return state_->statusNow();
}

std::optional<Picture> ViewerWindow::readView() const {
  if (!state_->scene || state_->picturesDrawn == 0) return std::nullopt;
  return state_->target->readPicture();
}

std::optional<Picture> ViewerWindow::readScreen() {
  if (!state_->composed) {
    state_->screenAsked = true;
    return std::nullopt;
  }
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
