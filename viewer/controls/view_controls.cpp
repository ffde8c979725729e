#include "viewer/controls/view_controls.h"

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>

namespace meshfront {
namespace {

constexpr double kZoomPerStep = 0.85;  // of the distance, a wheel step
// A drag across the picture's height turns by this much.
const double kTurnPerHeight = glm::radians(180.0);
// How near and far zooming may take the eye from its point, in bounding radii.
constexpr double kNearestZoom = 1e-4;
constexpr double kFarthestZoom = 1e3;

}  // namespace

void ViewControls::press(PointerButton button, bool shift, glm::dvec2 cursor) {
  if (drag_ != Drag::none) {
    return;
  }
  drag_ = button == PointerButton::left && !shift ? Drag::orbit : Drag::pan;
  dragButton_ = button;
  last_ = cursor;
}

void ViewControls::release(PointerButton button) {
  if (button == dragButton_) {
    drag_ = Drag::none;
  }
}

void ViewControls::move(glm::dvec2 cursor, PixelSize picture) {
  const glm::dvec2 moved = cursor - last_;
  last_ = cursor;
  if (drag_ == Drag::orbit) {
    const double perPixel = kTurnPerHeight / std::max(1, picture.height);
    orbit(camera_, -moved.x * perPixel, moved.y * perPixel);
  } else if (drag_ == Drag::pan) {
    pan(camera_, {moved.x, -moved.y}, picture.height);
  }
}

void ViewControls::scroll(double steps, glm::dvec2 cursor, PixelSize picture,
                          std::optional<float> depth) {
  if (picture.width <= 0 || picture.height <= 0) {
    return;
  }
  const auto projection = Projection::fit(camera_, bounds_, picture.aspect());
  const glm::dvec2 place(2 * cursor.x / picture.width - 1, 1 - 2 * cursor.y / picture.height);
  const glm::dvec3 point = depth.value_or(0) > 0 ? projection.worldPoint(place, *depth)
                                                 : projection.targetPlanePoint(place);
  const double factor = std::pow(kZoomPerStep, std::clamp(steps, -20.0, 20.0));
  const double distance = glm::length(camera_.eye - point) * factor / bounds_.radius();
  if ((factor < 1 && distance < kNearestZoom) || (factor > 1 && distance > kFarthestZoom)) {
    return;
  }
  zoomTo(camera_, point, factor);
}

void ViewControls::key(char letter, PixelSize picture) {
  switch (letter) {
    case 'F':
      fit(picture);
      break;
    case 'R':
      reset();
      break;
    case 'S':
      flatShading_ = !flatShading_;
      break;
    case 'W':
      wireframe_ = !wireframe_;
      break;
    case 'C':
      colours_ = !colours_;
      break;
    case 'H':
      helpShown_ = !helpShown_;
      break;
    case 'Q':
      quitAsked_ = true;
      break;
    default:
      break;
  }
}

}  // namespace meshfront
