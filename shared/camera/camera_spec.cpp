#include "shared/camera/camera_spec.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <utility>
#include <vector>

namespace meshfront {

const std::string_view kCameraSpecHelp =
    "A preset, or settings, or a preset and settings, with ';' between them (quote it).\n"
    "Presets:\n"
    "  whole                 the whole mesh fills the picture: zoom=1 (default)\n"
    "  half                  about half of it: zoom=2\n"
    "  close                 a close-up of its middle: zoom=4\n"
    "Settings:\n"
    "  azimuth=DEGREES       around the up axis, 0 from the front [30]\n"
    "  elevation=DEGREES     above the horizon, -90 to 90 [20]\n"
    "  zoom=FACTOR           narrows the view [1]\n"
    "  distance=RADII        eye to target in bounding radii [what fits]\n"
    "  target=X,Y,Z          the point in the middle, world units [bounds' centre]\n"
    "  up=X,Y,Z              or x, y, z [z if the mesh is flat in z, else y]\n"
    "  fov=DEGREES           vertical field of view at zoom 1, 1 to 150 [35]\n"
    "  eye=X,Y,Z             instead of azimuth, elevation and distance\n"
    "Example: 'close;azimuth=120;elevation=5'";

namespace {

constexpr double kHalfZoom = 2;
constexpr double kCloseZoom = 4;
// From straight above, the azimuth still says which way is up in the picture.
constexpr double kHighestElevation = 90 - 1e-3;
// A mesh at most this flat in z, against its shorter other side, is taken for a terrain.
constexpr double kTerrainFlatness = 1.0 / 3;

std::vector<std::string_view> splitAt(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) {
      return parts;
    }
    text.remove_prefix(end + 1);
  }
}

std::string_view trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(' ');
  if (begin == std::string_view::npos) {
    return {};
  }
  return text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

std::optional<double> parseNumber(std::string_view text) {
  text = trimmed(text);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

std::optional<glm::dvec3> parseVector(std::string_view text) {
  const auto parts = splitAt(text, ',');
  if (parts.size() != 3) {
    return std::nullopt;
  }
  glm::dvec3 vector(0);
  for (int i = 0; i < 3; ++i) {
    const auto number = parseNumber(parts[static_cast<size_t>(i)]);
    if (!number) {
      return std::nullopt;
    }
    vector[i] = *number;
  }
  return vector;
}

std::optional<glm::dvec3> parseUp(std::string_view text) {
  if (text == "x") return glm::dvec3(1, 0, 0);
  if (text == "y") return glm::dvec3(0, 1, 0);
  if (text == "z") return glm::dvec3(0, 0, 1);
  const auto vector = parseVector(text);
  return vector && glm::length(*vector) > 0 ? vector : std::nullopt;
}

tl::unexpected<Error> wrong(std::string_view part, std::string_view expected) {
  return fail("camera: '" + std::string(part) + "': expected " + std::string(expected));
}

struct NumberSetting {
  std::string_view key;
  double low;  // allowed range
  double high;
  std::string_view expected;
};
constexpr std::array<NumberSetting, 5> kNumberSettings = {{
    {"azimuth", -3600, 3600, "azimuth=DEGREES, -3600 to 3600"},
    {"elevation", -90, 90, "elevation=DEGREES, -90 to 90"},
    {"zoom", 1e-3, 1e6, "zoom=FACTOR, 0.001 to 1e6"},
    {"fov", 1e-6, 150, "fov=DEGREES, above 0 to 150"},
    {"distance", 1e-9, 1e9, "distance=RADII, above 0, in bounding radii"},
}};

Result<void> applyNumber(CameraSpec& spec, const NumberSetting& setting, std::string_view part,
                         std::string_view value) {
  const auto number = parseNumber(value);
  if (!number || *number < setting.low || *number > setting.high) {
    return wrong(part, setting.expected);
  }
  if (setting.key == "azimuth") spec.azimuth = *number;
  if (setting.key == "elevation") spec.elevation = *number;
  if (setting.key == "zoom") spec.zoom = *number;
  if (setting.key == "fov") spec.fov = *number;
  if (setting.key == "distance") spec.distance = *number;
  return {};
}

Result<void> applySetting(CameraSpec& spec, std::string_view part, std::string_view key,
                          std::string_view value) {
  for (const NumberSetting& setting : kNumberSettings) {
    if (setting.key == key) {
      return applyNumber(spec, setting, part, value);
    }
  }
  if (key == "target" || key == "eye") {
    const auto vector = parseVector(value);
    if (!vector) {
      return wrong(part, std::string(key) + "=X,Y,Z");
    }
    (key == "eye" ? spec.eye : spec.target) = vector;
    return {};
  }
  if (key == "up") {
    spec.up = parseUp(value);
    if (!spec.up) {
      return wrong(part, "up=X,Y,Z (not all zero) or up=x, up=y, up=z");
    }
    return {};
  }
  return wrong(part,
               "one of azimuth, elevation, zoom, distance, target, up, fov, eye, or first a preset "
               "whole, half or close");
}

bool applyPreset(CameraSpec& spec, std::string_view name) {
  if (name == "whole") {
    spec.zoom = 1;
  } else if (name == "half") {
    spec.zoom = kHalfZoom;
  } else if (name == "close") {
    spec.zoom = kCloseZoom;
  } else {
    return false;
  }
  return true;
}

glm::dvec3 upAxisOf(const Bounds& bounds) {
  const glm::dvec3 extent = bounds.extent();
  const bool terrain = extent.z < kTerrainFlatness * std::min(extent.x, extent.y);
  return terrain ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
}

// Where azimuth 0 looks from: +z when y is up, -y when z is up (a map seen from the south).
glm::dvec3 frontOf(const glm::dvec3& up) {
  const glm::dvec3 z(0, 0, 1);
  const glm::dvec3 front = z - up * glm::dot(up, z);
  return glm::length(front) > 1e-6 ? glm::normalize(front) : glm::dvec3(0, -1, 0);
}

void appendNumber(std::string& text, double value) {
  std::array<char, 32> digits{};
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text.append(digits.data(), result.ptr);
}

void appendVector(std::string& text, std::string_view key, const glm::dvec3& vector) {
  text += key;
  for (int i = 0; i < 3; ++i) {
    text += i == 0 ? "=" : ",";
    appendNumber(text, vector[i]);
  }
  text += ';';
}

}  // namespace

Result<CameraSpec> parseCameraSpec(std::string_view text) {
  CameraSpec spec;
  bool first = true;
  bool placedByAngles = false;
  for (std::string_view part : splitAt(text, ';')) {
    part = trimmed(part);
    if (first && (part.empty() || applyPreset(spec, part))) {
      first = false;
      continue;
    }
    first = false;
    if (part.empty()) {
      continue;
    }
    const size_t equals = part.find('=');
    const std::string_view key = trimmed(part.substr(0, equals));
    const std::string_view value =
        equals == std::string_view::npos ? "" : trimmed(part.substr(equals + 1));
    if (auto applied = applySetting(spec, part, key, value); !applied) {
      return tl::unexpected(applied.error());
    }
    placedByAngles |= key == "azimuth" || key == "elevation" || key == "distance";
  }
  if (spec.eye && placedByAngles) {
    return fail("camera: eye=X,Y,Z says where the eye is: leave out azimuth, elevation, distance");
  }
  if (spec.eye && spec.target && *spec.eye == *spec.target) {
    return fail("camera: eye and target are the same point");
  }
  return spec;
}

Camera placeCamera(const CameraSpec& spec, const Bounds& bounds, double aspect) {
  Camera camera;
  const double fov = glm::radians(spec.fov);
  camera.verticalFov = spec.zoom == 1 ? fov : 2 * std::atan(std::tan(0.5 * fov) / spec.zoom);
  camera.target = spec.target.value_or(bounds.center());
  camera.up = spec.up.value_or(upAxisOf(bounds));
  if (spec.eye) {
    camera.eye = *spec.eye;
    return camera;
  }
  const glm::dvec3 up = glm::normalize(camera.up);
  const glm::dvec3 front = frontOf(up);
  const glm::dvec3 side = glm::cross(up, front);
  const double azimuth = glm::radians(spec.azimuth);
  const double elevation =
      glm::radians(std::clamp(spec.elevation, -kHighestElevation, kHighestElevation));
  const glm::dvec3 toEye =
      std::cos(elevation) * (std::cos(azimuth) * front + std::sin(azimuth) * side) +
      std::sin(elevation) * up;
  camera.eye = camera.target + toEye * bounds.radius();
  const double zoomed = std::exchange(camera.verticalFov, fov);
  const double distance =
      spec.distance ? *spec.distance * bounds.radius() : fittingDistance(camera, bounds, aspect);
  camera.verticalFov = zoomed;
  camera.eye = camera.target + toEye * distance;
  return camera;
}

std::string formatCamera(const Camera& camera) {
  std::string text;
  appendVector(text, "eye", camera.eye);
  appendVector(text, "target", camera.target);
  appendVector(text, "up", camera.up);
  text += "fov=";
  appendNumber(text, glm::degrees(camera.verticalFov));
  return text;
}

}  // namespace meshfront
