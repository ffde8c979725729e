// A perspective camera in world coordinates, and the ways a person moves it.
//
// World coordinates may be georeferenced (10^7 metres): everything here is in double, and what goes
// to the GPU is taken relative to a point near the eye (Projection::clipFrom).
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "shared/camera/bounds.h"

namespace meshfront {

struct PixelSize {
  int width = 0;
  int height = 0;

  [[nodiscard]] double aspect() const {
    return width > 0 && height > 0 ? static_cast<double>(width) / height : 1;
  }
  bool operator==(const PixelSize&) const = default;
};

struct Camera {
  glm::dvec3 eye{0, 0, 1};
  glm::dvec3 target{0};
  glm::dvec3 up{0, 1, 0};     // need not be orthogonal to the view, need not be a unit vector
  double verticalFov = 0.61;  // radians, of the whole picture's height

  bool operator==(const Camera&) const = default;
};

// Of a length seen from as far away as it is long, across the view.
[[nodiscard]] double pixelsAtOne(const Camera& camera, PixelSize picture);

// Unit vectors of the view; right x upward = -forward. Also defined when `up` is along the view.
struct ViewAxes {
  glm::dvec3 right;
  glm::dvec3 upward;
  glm::dvec3 forward;
};
[[nodiscard]] ViewAxes viewAxes(const Camera& camera);

// How a camera maps the world to the picture. The depth is reversed, 1 at the near plane and 0 at
// the far plane and in the background (with float depth: evenly precise at every distance).
// Clip space is that of glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE).
struct Projection {
  Camera camera;
  double aspect = 1;
  double nearPlane = 0.1;  // distances along the view, fitted to the bounds' sphere
  double farPlane = 10;

  [[nodiscard]] static Projection fit(const Camera& camera, const Bounds& bounds, double aspect);

  // From coordinates relative to `origin` (a world point, best near the eye) to clip space.
  [[nodiscard]] glm::dmat4 clipFrom(const glm::dvec3& origin) const;
  // The same to view space: x right, y up, -z forward, in world units.
  [[nodiscard]] glm::dmat4 viewFrom(const glm::dvec3& origin) const;
  // The world point at a place of the picture, (-1,-1) its lower left and (1,1) its upper right
  // corner, seen at a depth-buffer value above 0.
  [[nodiscard]] glm::dvec3 worldPoint(glm::dvec2 place, double depth) const;
  // The same on the plane through the target that faces the camera.
  [[nodiscard]] glm::dvec3 targetPlanePoint(glm::dvec2 place) const;

 private:
  [[nodiscard]] glm::dvec3 atDistance(glm::dvec2 place, double alongView) const;
};

// --- moving it -----------------------------------------------------------------------------------

// Turntable around the target: `turn` about the up vector, `lift` over the horizon (radians; a
// positive turn moves the eye to its right, a positive lift upward). Stops short of the poles.
void orbit(Camera& camera, double turn, double lift);
// Moves eye and target so that what lies `distance` along the view, else at the target's distance,
// follows the cursor; `pixels` to the right and up, in a picture `pictureHeight` pixels high.
void pan(Camera& camera, glm::dvec2 pixels, int pictureHeight,
         std::optional<double> distance = std::nullopt);
// Turns the picture clockwise around its middle, radians.
void roll(Camera& camera, double angle);
// Scales the view's distance to `point` by `factor` (below 1: nearer); the point stays where it is
// in the picture.
void zoomTo(Camera& camera, const glm::dvec3& point, double factor);
// Keeps the direction; looks at the bounds' centre from where the box just fits the picture.
void fitTo(Camera& camera, const Bounds& bounds, double aspect);
// How far along the camera's view its eye must be from the target for the box to fit the picture.
[[nodiscard]] double fittingDistance(const Camera& camera, const Bounds& bounds, double aspect);

}  // namespace meshfront
