// What a person can switch in a view, beside the camera.
#pragma once

#include <cstdint>
#include <string_view>

namespace meshfront {

enum class ColouringMode : uint8_t {
  own,      // the mesh's colours where it has any, else clay
  clay,     // one colour
  tree,     // by tree of the hierarchy
  level,    // by significance level
  pixels,   // by pixels counted for the ranking
  missing,  // what may still be split, against what is final
};
inline constexpr unsigned kColourings = 6;

[[nodiscard]] constexpr std::string_view colouringModeName(ColouringMode colouring) {
  switch (colouring) {
    case ColouringMode::own:
      return "own colours";
    case ColouringMode::clay:
      return "clay";
    case ColouringMode::tree:
      return "tree";
    case ColouringMode::level:
      return "level";
    case ColouringMode::pixels:
      return "pixels";
    case ColouringMode::missing:
      return "missing";
  }
  return "";
}

struct ViewSwitches {
  bool flatShading = false;
  bool wireframe = false;
  ColouringMode colouring = ColouringMode::own;
  bool missingBounds = false;  // circles around what is still missing
  bool geomorph = true;        // splits slide instead of popping
  bool panel = true;
  bool help = false;

  bool operator==(const ViewSwitches&) const = default;
};

}  // namespace meshfront
