#include "viewer/controls/view_controls.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <utility>

namespace meshfront {
namespace {

constexpr double kZoomPerStep = 0.85;  // of the distance, a wheel step
constexpr double kStepsPerKey = 1.5;   // wheel steps that + and - are worth
constexpr double kMostSteps = 20;      // at once
// A drag across the picture's height turns by this much.
const double kTurnPerHeight = glm::radians(180.0);
const double kTurnPerKey = glm::radians(7.5);
constexpr double kPanPerKey = 0.06;  // of the picture's height
// How near and far zooming may take the eye from its point, in bounding radii.
constexpr double kNearestZoom = 1e-4;
constexpr double kFarthestZoom = 1e3;
// A press that moves less is a click; two of them that are nearer and sooner are a double click.
constexpr double kClickPixels = 4;
constexpr double kDoubleClickPixels = 8;
constexpr double kDoubleClickSeconds = 0.4;

glm::dvec2 placeInView(glm::dvec2 pixel, PixelSize picture) {
  return {2 * pixel.x / picture.width - 1, 1 - 2 * pixel.y / picture.height};
}

}  // namespace

void ViewControls::handle(const InputEvent& event, PixelSize picture, double seconds) {
  if (picture.width <= 0 || picture.height <= 0) {
    return;
  }
  if (const auto* moved = std::get_if<PointerMoved>(&event)) {
    move(moved->place, picture);
  } else if (const auto* pressed = std::get_if<PointerPressed>(&event)) {
    press(*pressed, seconds);
  } else if (const auto* released = std::get_if<PointerReleased>(&event)) {
    release(*released, seconds);
  } else if (const auto* scrolled = std::get_if<Scrolled>(&event)) {
    scroll(scrolled->steps.y, picture);
  } else if (const auto* pushed = std::get_if<KeyPressed>(&event)) {
    key(*pushed, picture);
  }
}

std::optional<glm::dvec3> ViewControls::surfaceAt(glm::dvec2 place) const {
  return probe_ ? probe_(place) : std::nullopt;
}

double ViewControls::distanceAlongView(const glm::dvec3& point) const {
  return glm::dot(point - camera_.eye, viewAxes(camera_).forward);
}

void ViewControls::setCamera(const Camera& camera) {
  camera_ = camera;
  zoomPoint_.reset();
}

void ViewControls::setHome(const Camera& start, const Bounds& bounds) {
  start_ = start;
  bounds_ = bounds;
}

void ViewControls::fit(PixelSize picture) {
  fitTo(camera_, bounds_, picture.aspect());
  zoomPoint_.reset();
}

std::vector<ViewCommand> ViewControls::takeCommands() {
  return std::exchange(commands_, {});
}

// --- pointer -------------------------------------------------------------------------------------

void ViewControls::press(const PointerPressed& event, double seconds) {
  if (drag_ != Drag::none) {
    return;
  }
  const Modifiers& with = event.modifiers;
  drag_ = Drag::waiting;
  dragKind_ = Drag::orbit;
  if (event.button != PointerButton::left || with.shift) {
    dragKind_ = Drag::pan;
  } else if (with.control || with.alt) {
    dragKind_ = Drag::roll;
  }
  dragButton_ = event.button;
  pressedAt_ = pointer_;
  doubleClick_ = event.button == PointerButton::left && clickedWhen_ &&
                 seconds - *clickedWhen_ < kDoubleClickSeconds &&
                 glm::length(pointer_ - clickedAt_) < kDoubleClickPixels * pixelScale_;
  grabbedDistance_.reset();
  if (dragKind_ == Drag::pan) {
    if (const auto point = surfaceAt(pointer_)) {
      grabbedDistance_ = distanceAlongView(*point);
    }
  }
}

void ViewControls::release(const PointerReleased& event, double seconds) {
  if (event.button != dragButton_) {
    return;
  }
  const bool clicked = std::exchange(drag_, Drag::none) == Drag::waiting;
  if (!clicked || event.button != PointerButton::left) {
    return;
  }
  if (doubleClick_) {
    clickedWhen_.reset();
    if (const auto point = surfaceAt(pointer_)) {
      recentre(*point);
    }
    return;
  }
  clickedWhen_ = seconds;
  clickedAt_ = pointer_;
  ask(dragKind_ == Drag::pan ? ViewCommand::Kind::measure : ViewCommand::Kind::pick);
}

void ViewControls::move(glm::dvec2 place, PixelSize picture) {
  const glm::dvec2 from = std::exchange(pointer_, place);
  if (place != from) {
    zoomPoint_.reset();
  }
  if (drag_ == Drag::none) {
    return;
  }
  glm::dvec2 moved = place - from;
  if (drag_ == Drag::waiting) {
    if (glm::length(place - pressedAt_) < kClickPixels * pixelScale_) {
      return;
    }
    drag_ = dragKind_;
    moved = place - pressedAt_;
  }
  if (drag_ == Drag::orbit) {
    const double perPixel = kTurnPerHeight / picture.height;
    orbit(camera_, -moved.x * perPixel, moved.y * perPixel);
  } else if (drag_ == Drag::pan) {
    pan(camera_, {moved.x, -moved.y}, picture.height, grabbedDistance_);
  } else if (drag_ == Drag::roll) {
    // The picture turns with the pointer around its middle.
    const glm::dvec2 middle(0.5 * picture.width, 0.5 * picture.height);
    const glm::dvec2 a = place - moved - middle;
    const glm::dvec2 b = place - middle;
    const double turned = std::atan2(a.x * b.y - a.y * b.x, glm::dot(a, b));
    roll(camera_, turned);
  }
}

void ViewControls::scroll(double steps, PixelSize picture) {
  if (!(steps != 0) || !std::isfinite(steps)) {
    return;  // sideways only
  }
  if (!zoomPoint_) {
    const auto surface = surfaceAt(pointer_);
    if (surface) {
      // From now on orbits turn about what one has gone to.
      const ViewAxes axes = viewAxes(camera_);
      const double distance = distanceAlongView(*surface);
      if (distance > 0) camera_.target = camera_.eye + axes.forward * distance;
    }
    const auto projection = Projection::fit(camera_, bounds_, picture.aspect());
    zoomPoint_ = surface ? *surface : projection.targetPlanePoint(placeInView(pointer_, picture));
  }
  zoom(*zoomPoint_, steps);
}

void ViewControls::zoom(const glm::dvec3& point, double steps) {
  double factor = std::pow(kZoomPerStep, std::clamp(steps, -kMostSteps, kMostSteps));
  const double distance = glm::length(camera_.eye - point) / bounds_.radius();
  if (!(distance > 0)) {
    return;
  }
  // From beyond an end one may come back, but go no further.
  const double nearest = std::min(1.0, kNearestZoom / distance);
  const double farthest = std::max(1.0, kFarthestZoom / distance);
  factor = std::clamp(factor, nearest, farthest);
  zoomTo(camera_, point, factor);
}

void ViewControls::recentre(const glm::dvec3& point) {
  // Its distance stays: what was looked at keeps its size.
  const double distance = distanceAlongView(point);
  camera_.target = point;
  camera_.eye = point - viewAxes(camera_).forward * distance;
  zoomPoint_.reset();
}

// --- keys ----------------------------------------------------------------------------------------

void ViewControls::key(const KeyPressed& event, PixelSize picture) {
  const auto code = static_cast<unsigned char>(event.key);
  if (code >= 'A' && code <= 'Z') {
    letter(static_cast<char>(code), event.modifiers, picture);
    return;
  }
  switch (event.key) {
    case Key::left:
    case Key::right:
    case Key::up:
    case Key::down:
      arrow(event.key, event.modifiers.shift, picture);
      break;
    case Key::plus:
      zoom(camera_.target, kStepsPerKey);
      break;
    case Key::minus:
      zoom(camera_.target, -kStepsPerKey);
      break;
    case Key::leftBracket:
      roll(camera_, -kTurnPerKey);
      break;
    case Key::rightBracket:
      roll(camera_, kTurnPerKey);
      break;
    case Key::home:
      reset();
      break;
    case Key::escape:
      quit();
      break;
    case Key::tab:
      switches_.panel = !switches_.panel;
      break;
    case Key::f1:
    case Key::question:
      switches_.help = !switches_.help;
      break;
    case Key::f12:
      ask(ViewCommand::Kind::screenshot);
      break;
    case Key::deleteKey:
      ask(ViewCommand::Kind::clearPicks);
      break;
    default:
      break;
  }
}

void ViewControls::letter(char upperCase, Modifiers modifiers, PixelSize picture) {
  if (modifiers.control) {
    // Other letters keep to themselves: a person who holds Ctrl means none of the switches.
    if (upperCase == 'C') ask(ViewCommand::Kind::copyCamera);
    if (upperCase == 'S') ask(ViewCommand::Kind::screenshot);
    if (upperCase == 'Q' || upperCase == 'W') quit();
    return;
  }
  if (modifiers.alt) {
    return;  // the desktop's
  }
  switch (upperCase) {
    case 'F':
      fit(picture);
      break;
    case 'R':
      reset();
      break;
    case 'S':
      switches_.flatShading = !switches_.flatShading;
      break;
    case 'W':
      switches_.wireframe = !switches_.wireframe;
      break;
    case 'C':
      nextColouring(modifiers.shift);
      break;
    case 'B':
      switches_.missingBounds = !switches_.missingBounds;
      break;
    case 'G':
      switches_.geomorph = !switches_.geomorph;
      break;
    case 'P':
      switches_.panel = !switches_.panel;
      break;
    case 'H':
      switches_.help = !switches_.help;
      break;
    case 'X':
      ask(ViewCommand::Kind::refineHere);
      break;
    case 'Q':
      quit();
      break;
    default:
      break;
  }
}

void ViewControls::arrow(Key key, bool panning, PixelSize picture) {
  const double x = key == Key::left ? -1 : key == Key::right ? 1 : 0;
  const double y = key == Key::down ? -1 : key == Key::up ? 1 : 0;
  zoomPoint_.reset();
  if (panning) {
    pan(camera_, glm::dvec2(x, y) * (kPanPerKey * picture.height), picture.height);
  } else {
    orbit(camera_, -x * kTurnPerKey, -y * kTurnPerKey);  // as a drag that way
  }
}

void ViewControls::nextColouring(bool backward) {
  auto next = static_cast<unsigned>(switches_.colouring);
  do {
    next = (next + (backward ? kColourings - 1 : 1)) % kColourings;
  } while (static_cast<ColouringMode>(next) == ColouringMode::clay && !hasColours_);
  switches_.colouring = static_cast<ColouringMode>(next);
}

}  // namespace meshfront
