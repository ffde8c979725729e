#include "viewer/window/window_state.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "shared/camera/camera_spec.h"
#include "viewer/window/overlays.h"
#include "viewer/window/screenshot_file.h"
#include "viewer/window/status_panel.h"

namespace meshfront {
namespace {

constexpr double kStatusInterval = 0.1;  // seconds between looks at what the panel shows
// ImGui finds sizes and what is hovered in one frame and uses them in the next.
constexpr int kTurnsToSettle = 3;
constexpr double kNextFrame = 1.0 / 60;
constexpr double kNoteShown = 3;  // seconds
constexpr size_t kMostPicks = 2;
const std::array<float, 4> kEmptyBackground = {0.90F, 0.905F, 0.915F, 1};  // as DrawStyle's

// What the panel would show alike need not be drawn again for what it does not show.
bool showsTheSame(PanelStatus a, const PanelStatus& b) {
  a.frame = b.frame;
  a.picturesDrawn = b.picturesDrawn;
  return a == b;
}

}  // namespace

void ViewerWindow::State::start() {
  window.onInput = [this](const InputEvent& event) {
    if (!options.scripted) take(event);
  };
  window.onExposed = [this] { turnsToShow = std::max(turnsToShow, 1); };
  window.onFocusLost = [this] { controls->cancelDrag(); };
  window.onScale = [this](double scale) {
    if (options.interfaceScale > 0) return;
    gui->setScale(scale);
    controls->setPixelScale(scale);
    turnsToShow = kTurnsToSettle;
  };
  controls->setSurfaceProbe([this](glm::dvec2 place) -> std::optional<glm::dvec3> {
    const auto found = surfaceAt(place);
    return found ? std::optional(found->world) : std::nullopt;
  });
}

void ViewerWindow::State::placeScene(const SceneView& wanted) {
  if (scene == wanted) return;
  const Camera before = home;
  home = placeCamera(options.camera, wanted.bounds, window.pictureSize().aspect());
  controls->setHome(home, wanted.bounds);
  controls->setHasColours(wanted.hasColours);
  if (!scene || controls->camera() == before) controls->setCamera(home);
  scene = wanted;
  pictureStale = true;
}

// --- input ---------------------------------------------------------------------------------------

void ViewerWindow::State::take(const InputEvent& event) {
  turnsToShow = kTurnsToSettle;
  gui->take(event);
  const bool atPointer =
      std::holds_alternative<PointerPressed>(event) || std::holds_alternative<Scrolled>(event);
  if (atPointer && Gui::takesPointer()) return;
  controls->handle(event, window.pictureSize(), GlfwWindow::seconds());
}

std::optional<SurfacePlace> ViewerWindow::State::surfaceAt(glm::dvec2 place) const {
  // The depth on the screen is of the drawn camera.
  if (!scene || drawnCamera != controls->camera() || drawnSize != window.pictureSize()) {
    return std::nullopt;
  }
  const float depth =
      target->depthAt(static_cast<int>(std::floor(place.x)), static_cast<int>(std::floor(place.y)));
  if (!(depth > 0)) return std::nullopt;
  const auto projection = Projection::fit(*drawnCamera, scene->bounds, drawnSize.aspect());
  const glm::dvec2 inView(2 * place.x / drawnSize.width - 1, 1 - 2 * place.y / drawnSize.height);
  return SurfacePlace{place, projection.worldPoint(inView, depth)};
}

void ViewerWindow::State::carryOut(const ViewCommand& command) {
  using Kind = ViewCommand::Kind;
  if (!scene) return;
  switch (command.kind) {
    case Kind::pick:
    case Kind::measure:
      if (const auto place = surfaceAt(command.place)) pick(*place, command.kind == Kind::measure);
      break;
    case Kind::clearPicks:
      picks.clear();
      break;
    case Kind::refineHere:
      if (const auto place = surfaceAt(command.place); !place) {
        say("nothing to refine here: point at the surface", false);
      } else if (callbacks->refineHere) {
        say(callbacks->refineHere(*place), false);
      }
      break;
    case Kind::screenshot:
      saveScreenshot();
      break;
    case Kind::copyCamera:
      copyCamera();
      break;
  }
}

void ViewerWindow::State::pick(const SurfacePlace& place, bool fromFirst) {
  PickedPoint point;
  if (callbacks->pick) point = callbacks->pick(place);
  point.world = place.world;
  if (picks.size() == kMostPicks) picks.erase(fromFirst ? picks.end() - 1 : picks.begin());
  picks.push_back(std::move(point));
  ++picksMade;
}

void ViewerWindow::State::saveScreenshot() {
  const auto written = writeNumberedScreenshot(target->readPicture(), ".");
  say(written ? "saved " + written->filename().string() : written.error().message, true);
}

void ViewerWindow::State::copyCamera() {
  const std::string option = "--camera '" + formatCamera(controls->camera()) + "'";
  window.copy(option);
  say("copied " + option, false);
  if (callbacks->say) callbacks->say(option);
}

void ViewerWindow::State::say(const std::string& text, bool inTerminal) {
  note = text;
  noteUntil = GlfwWindow::seconds() + kNoteShown;
  turnsToShow = kTurnsToSettle;
  if (inTerminal && callbacks->say) callbacks->say(text);
}

// --- a turn --------------------------------------------------------------------------------------

Result<double> ViewerWindow::State::turn() {
  const double begin = GlfwWindow::seconds();
  composed = false;
  for (const ViewCommand& command : controls->takeCommands()) carryOut(command);
  const SceneTurn turned = callbacks->turn ? callbacks->turn() : SceneTurn{};
  const PixelSize size = window.pictureSize();
  if (size.width < 1 || size.height < 1) {
    if (callbacks->turnEnd) callbacks->turnEnd();
    return options.quietWait;  // minimised
  }
  if (auto resized = target->resize(size); !resized) return tl::unexpected(resized.error());
  const Result<bool> drawn = drawPicture(turned);
  if (!drawn) return tl::unexpected(drawn.error());
  composed = compose(*drawn);
  if (callbacks->turnEnd) callbacks->turnEnd();
  if (composed) window.swap();
  if (*drawn) frames.add(GlfwWindow::seconds(), GlfwWindow::seconds() - begin);
  if (turned.moving || pictureStale) return 0.0;
  if (turnsToShow > 0 || screenAsked) return kNextFrame;
  if (options.scripted) return kNextFrame;  // the script's next step is due
  return turned.busy ? options.busyWait : options.quietWait;
}

Result<bool> ViewerWindow::State::drawPicture(const SceneTurn& turned) {
  const PixelSize size = target->size();
  const bool viewChanged = drawnCamera != controls->camera() || drawnSize != size;
  const bool sceneChanged = turned.changed || turned.moving;
  ViewSwitches switches = controls->switches();
  switches.panel = drawnSwitches.panel;  // these two are not in the picture
  switches.help = drawnSwitches.help;
  if (!viewChanged && !sceneChanged && !pictureStale && switches == drawnSwitches) return false;
  pictureStale = false;
  drawnSize = size;
  drawnSwitches = switches;
  if (!scene || !callbacks->draw) {
    glClearNamedFramebufferfv(target->framebuffer(), GL_COLOR, 0, kEmptyBackground.data());
    drawnCamera = controls->camera();
    return true;
  }
  drawnCamera = controls->camera();
  const ViewToDraw view{*target, *drawnCamera, scene->bounds, switches, viewChanged, sceneChanged};
  if (auto drawn = callbacks->draw(view); !drawn) return tl::unexpected(drawn.error());
  ++picturesDrawn;
  return true;
}

bool ViewerWindow::State::compose(bool drawn) {
  const double now = GlfwWindow::seconds();
  if (!note.empty() && now > noteUntil) {
    note.clear();
    turnsToShow = std::max(turnsToShow, 1);
  }
  if (now - shownAt >= kStatusInterval || turnsToShow > 0) {
    PanelStatus latest = statusNow();
    if (!showsTheSame(latest, shown)) turnsToShow = std::max(turnsToShow, 1);
    shown = std::move(latest);
    shownAt = now;
  }
  if (!drawn && turnsToShow == 0 && !screenAsked) return false;
  turnsToShow = std::max(0, turnsToShow - 1);
  screenAsked = false;
  paint();
  return true;
}

void ViewerWindow::State::paint() {
  glDisable(GL_SCISSOR_TEST);  // ImGui's last frame left it; it would cut the copy
  target->blitToWindow(drawnSize);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, drawnSize.width, drawnSize.height);
  gui->begin(drawnSize, GlfwWindow::seconds());
  ViewSwitches& switches = controls->switches();
  if (shown.message && !switches.help) drawMessage(*shown.message, drawnSize, !scene.has_value());
  if (scene && !switches.help) {
    const auto projection = Projection::fit(*drawnCamera, scene->bounds, drawnSize.aspect());
    drawPicks(shown, projection, drawnSize);
    if (switches.panel) drawStatusPanel(shown, *controls, drawnSize);
  }
  if (!shown.note.empty()) drawNote(shown.note, drawnSize, !shown.picks.empty());
  if (switches.help) switches.help = drawHelp(drawnSize);
  Gui::end();
}

PanelStatus ViewerWindow::State::statusNow() const {
  PanelStatus status =
      callbacks != nullptr && callbacks->status ? callbacks->status() : PanelStatus{};
  const ViewSwitches& switches = controls->switches();
  status.frame = frames.times(GlfwWindow::seconds());
  status.picturesDrawn = picturesDrawn;
  status.pictureSize = {drawnSize.width, drawnSize.height};
  status.camera = scene ? formatCamera(controls->camera()) : "";
  status.shading = switches.flatShading ? "flat" : "smooth";
  status.colouring = std::string(colouringModeName(switches.colouring));
  status.wireframe = switches.wireframe;
  status.missingBounds = switches.missingBounds;
  status.geomorph = switches.geomorph;
  status.panelShown = switches.panel;
  status.helpShown = switches.help;
  status.picks = picks;
  status.picksMade = picksMade;
  if (picks.size() == kMostPicks) {
    status.pickDistance = glm::length(picks[1].world - picks[0].world);
  }
  status.note = note;
  return status;
}

}  // namespace meshfront
