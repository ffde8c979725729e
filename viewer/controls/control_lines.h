// What does what in a view, for people: the help overlay and the README.
#pragma once

#include <array>
#include <string_view>

namespace meshfront {

struct ControlLine {
  std::string_view input;  // empty: `meaning` is the heading of those that follow
  std::string_view meaning;
};

inline constexpr std::array<ControlLine, 28> kControlLines = {{
    {"", "Move"},
    {"left drag", "orbit"},
    {"middle or right drag, Shift + left drag", "pan"},
    {"Ctrl or Alt + left drag, [ ]", "roll"},
    {"wheel, two fingers", "zoom to the pointer"},
    {"+ -", "zoom to the middle"},
    {"arrows, Shift + arrows", "orbit, pan"},
    {"double click", "centre what is under the pointer"},
    {"F", "fit everything into the window"},
    {"R, Home", "back to the first view"},
    {"", "Look"},
    {"S", "smooth or flat shading"},
    {"W", "wireframe"},
    {"C, Shift + C", "next, previous colouring"},
    {"B", "circles around what is missing"},
    {"G", "splits slide or pop"},
    {"", "Measure"},
    {"click", "pick a point; the distance from the last one"},
    {"Shift + click", "measure from the first point again"},
    {"Delete", "forget the points"},
    {"X", "refine what is under the pointer first"},
    {"", "Keep"},
    {"F12, Ctrl + S", "screenshot to the current folder"},
    {"Ctrl + C", "copy the camera as --camera option"},
    {"", "Window"},
    {"P, Tab", "panel"},
    {"H, F1, ?", "this help"},
    {"Q, Esc", "quit"},
}};

}  // namespace meshfront
