// A script that drives the viewer's window as a person would: a step a line.
//
//   size WIDTH HEIGHT                        of the window, and wait until it is so
//   wait SECONDS                             0 to 600
//   wait-frames N                            turns of the window's loop, each shown if it changed
//   wait-state STATE TIMEOUT                 connecting | refining | settled | complete |
//                                            degraded | limit-reached; it must hold for a moment
//   wait-until FIELD OP VALUE TIMEOUT        a field of the status; fails after TIMEOUT seconds
//   move X Y                                 the pointer; pixels of the picture from its upper left
//   press BUTTON [MODIFIERS]                 left | middle | right; shift+ctrl+alt, joined by +
//   release BUTTON [MODIFIERS]
//   click X Y [MODIFIERS]                    with the left button
//   double-click X Y
//   drag X1 Y1 X2 Y2 BUTTON [MODIFIERS] [STEPS]   in STEPS moves, 1 to 1000 [10]
//   scroll X Y STEPS                         of the wheel, positive nearer; a touchpad's are
//                                            fractions
//   key NAME [MODIFIERS]                     A to Z, left, home, F12, + ...
//   pick X Y                                 a click that must find the surface
//   camera SPEC                              as --camera's
//   screenshot FILE                          PNG of all that the window shows, panel included
//   picture FILE                             PNG of the view alone
//   compare FILE TOLERANCE                   the view with a PNG: psnr:DB at least, or mean:D, the
//                                            mean absolute difference of a channel (0 to 255) at
//                                            most
//   status FILE                              everything that the panel knows, as JSON
//   expect FIELD OP VALUE                    of that JSON: state == settled, picks.0.world.2 > 0.1,
//                                            picks.size == 2, message.title contains away
//                                            OP: == != < <= > >= contains
//   print TEXT                               a line on stderr
//   run "COMMAND"                            by /bin/sh, to its end (60 s at most); fails unless it
//                                            ends with 0. Whoever gives a script gives it this
//                                            power: play no script of which you do not know what it
//                                            does.
//   quit
//
// Words are parted by blanks; "..." keeps blanks, with \" and \\ in it; # begins a comment. Paths
// are relative to the current folder. The window closes at the end of the script.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "shared/camera/camera.h"
#include "shared/camera/camera_spec.h"
#include "shared/result.h"
#include "viewer/controls/input_event.h"

namespace meshfront {

// For --help; lines of at most 80 characters.
extern const std::string_view kScriptHelp;

// A field of the status JSON, by names and numbers with dots between, against a value.
struct StatusCondition {
  enum class Operator : uint8_t { equal, unequal, less, atMost, greater, atLeast, contains };
  std::string field;
  Operator is = Operator::equal;
  std::string value;
};

struct SizeStep {
  PixelSize size;
};
struct WaitStep {
  double seconds = 0;
};
struct WaitFramesStep {
  uint32_t turns = 0;
};
struct WaitUntilStep {
  StatusCondition condition;
  double timeout = 0;  // seconds
  double holds = 0;    // seconds that it must be true without a break
};
struct InputStep {
  std::vector<InputEvent> events;  // all in one turn
};
struct DragStep {
  glm::dvec2 from{0};
  glm::dvec2 to{0};
  PointerButton button = PointerButton::left;
  Modifiers modifiers;
  uint32_t steps = 10;
};
struct PickStep {
  glm::dvec2 place{0};
};
struct CameraStep {
  CameraSpec spec;
};
struct ScreenshotStep {
  std::filesystem::path file;
};
struct PictureStep {
  std::filesystem::path file;
};
struct CompareStep {
  enum class Measure : uint8_t { psnr, mean };
  std::filesystem::path file;
  Measure measure = Measure::psnr;
  double tolerance = 0;
};
struct StatusStep {
  std::filesystem::path file;
};
struct ExpectStep {
  StatusCondition condition;
};
struct PrintStep {
  std::string text;
};
struct RunStep {
  std::string command;
};
struct QuitStep {};

using ScriptAction =
    std::variant<SizeStep, WaitStep, WaitFramesStep, WaitUntilStep, InputStep, DragStep, PickStep,
                 CameraStep, ScreenshotStep, PictureStep, CompareStep, StatusStep, ExpectStep,
                 PrintStep, RunStep, QuitStep>;
struct ScriptStep {
  uint32_t line = 0;  // from 1
  std::string text;   // as it stands there
  ScriptAction action;
};

inline constexpr size_t kMaxScriptBytes = 1 << 20;
inline constexpr size_t kMaxScriptSteps = 100'000;

// `name` stands in front of messages: "tour.txt:12: ...", which say what may stand there.
[[nodiscard]] Result<std::vector<ScriptStep>> parseScript(std::string_view text,
                                                          const std::string& name);
[[nodiscard]] Result<std::vector<ScriptStep>> readScript(const std::filesystem::path& file);

}  // namespace meshfront
