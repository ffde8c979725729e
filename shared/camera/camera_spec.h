// The camera as a person writes it on a command line, `--camera SPEC`.
//
//   auto spec = parseCameraSpec("close;azimuth=120");     // before anything is known of the mesh
//   Camera camera = placeCamera(*spec, bounds, aspect);   // when its bounds are known
//   std::cout << formatCamera(camera);                    // an exact spec of where one is
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "shared/camera/bounds.h"
#include "shared/camera/camera.h"
#include "shared/result.h"

namespace meshfront {

// For --help; lines of at most 80 characters.
extern const std::string_view kCameraSpecHelp;

struct CameraSpec {
  double azimuth = 30;               // degrees around the up axis, 0 = from the front
  double elevation = 20;             // degrees above the horizon, -90 .. 90
  double zoom = 1;                   // > 0
  double fov = 35;                   // degrees, before zoom; 1 .. 150
  std::optional<double> distance;    // from the target, in bounding radii, > 0; else what fits
  std::optional<glm::dvec3> target;  // world; else the bounds' centre
  std::optional<glm::dvec3> up;      // world; else z for a mesh flat in z, y for all others
  std::optional<glm::dvec3> eye;     // world; excludes azimuth, elevation and distance
};

// Errors name the part that is wrong and what may stand there.
[[nodiscard]] Result<CameraSpec> parseCameraSpec(std::string_view text);
[[nodiscard]] Camera placeCamera(const CameraSpec& spec, const Bounds& bounds, double aspect);
// eye=..;target=..;up=..;fov=.. with every digit: parsing and placing it gives the camera again
// (the angle up to rounding).
[[nodiscard]] std::string formatCamera(const Camera& camera);

}  // namespace meshfront
