#include "viewer/script/script.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <utility>

#include "viewer/script/script_words.h"

namespace meshfront {

const std::string_view kScriptHelp =
    "Steps, one a line; # begins a comment, \"...\" keeps blanks:\n"
    "  size W H, wait SECONDS, wait-frames N, wait-state STATE TIMEOUT,\n"
    "  wait-until FIELD OP VALUE TIMEOUT, move X Y, press BUTTON [MODIFIERS],\n"
    "  release BUTTON [MODIFIERS], click X Y [MODIFIERS], double-click X Y,\n"
    "  drag X1 Y1 X2 Y2 BUTTON [MODIFIERS] [STEPS], scroll X Y STEPS,\n"
    "  key NAME [MODIFIERS], pick X Y, camera SPEC, screenshot FILE, picture FILE,\n"
    "  compare FILE psnr:DB|mean:D, status FILE, expect FIELD OP VALUE, print TEXT,\n"
    "  run \"COMMAND\" (by /bin/sh: play only scripts that you know), quit\n"
    "STATE: connecting, refining, settled, complete, degraded, limit-reached.\n"
    "MODIFIERS: shift, ctrl, alt, joined by +. FIELD: of the JSON that status writes,\n"
    "as in picks.0.world.2. OP: == != < <= > >= contains.";

namespace {

constexpr double kLongestWait = 600;        // seconds
constexpr double kFarthestPixel = 100'000;  // may lie outside of the picture
constexpr int kWidestWindow = 16'384;
constexpr double kMostScroll = 1000;
constexpr double kStateHolds = 0.15;  // seconds: a state just left is not yet known to be so

// The words behind a step's name. Each take says what it expected; the first error stays.
class Words {
 public:
  explicit Words(std::vector<std::string> words) : words_(std::move(words)) {}

  [[nodiscard]] bool atEnd() const { return next_ == words_.size(); }
  [[nodiscard]] const std::string& problem() const { return problem_; }

  void expected(const std::string& what) {
    if (!problem_.empty()) return;
    problem_ = "expected " + what;
    problem_ += next_ < words_.size() ? ", not '" + words_[next_].substr(0, 100) + "'"
                                      : ", and the line ends here";
  }

  // The same of the word before.
  void wrongWord(const std::string& what, const std::string& word) {
    if (problem_.empty()) problem_ = "expected " + what + ", not '" + word.substr(0, 100) + "'";
  }

  std::string word(const std::string& what) {
    if (atEnd() || words_[next_].empty()) {
      expected(what);
      return {};
    }
    return words_[next_++];
  }

  double number(const std::string& what, double low, double high) {
    const auto value = atEnd() ? std::nullopt : numberIn(words_[next_]);
    if (!value || *value < low || *value > high) {
      expected(what);
      return low;
    }
    ++next_;
    return *value;
  }

  uint32_t count(const std::string& what, uint32_t low, uint32_t high) {
    const double value = number(what, low, high);
    if (value != std::floor(value)) {
      --next_;
      expected(what);
    }
    return static_cast<uint32_t>(value);
  }

  glm::dvec2 place() {
    const double x = number("a place X Y in pixels", -kFarthestPixel, kFarthestPixel);
    const double y = number("a place X Y in pixels", -kFarthestPixel, kFarthestPixel);
    return {x, y};
  }

  PointerButton button() {
    constexpr std::array<std::pair<std::string_view, PointerButton>, 3> kButtons = {
        {{"left", PointerButton::left},
         {"middle", PointerButton::middle},
         {"right", PointerButton::right}}};
    for (const auto& [name, button] : kButtons) {
      if (!atEnd() && words_[next_] == name) {
        ++next_;
        return button;
      }
    }
    expected("a button: left, middle or right");
    return PointerButton::left;
  }

  // None if the next word is something else.
  std::optional<Modifiers> modifiersIfAny() {
    if (atEnd()) return std::nullopt;
    Modifiers with;
    std::string_view rest = words_[next_];
    while (true) {
      const size_t plus = rest.find('+');
      const std::string_view name = rest.substr(0, plus);
      if (name == "shift") {
        with.shift = true;
      } else if (name == "ctrl") {
        with.control = true;
      } else if (name == "alt") {
        with.alt = true;
      } else {
        return std::nullopt;
      }
      if (plus == std::string_view::npos) break;
      rest.remove_prefix(plus + 1);
    }
    ++next_;
    return with;
  }

  // Those that end the line.
  Modifiers modifiersAtEnd() {
    const Modifiers with = modifiersIfAny().value_or(Modifiers{});
    if (!atEnd()) expected("modifiers (shift, ctrl, alt, joined by +) or the end of the line");
    return with;
  }

 private:
  static std::optional<double> numberIn(const std::string& text) {
    double value = 0;
    const char* end = text.data() + text.size();
    const auto [stop, code] = std::from_chars(text.data(), end, value);
    return code == std::errc() && stop == end && std::isfinite(value) ? std::optional(value)
                                                                      : std::nullopt;
  }

  std::vector<std::string> words_;
  size_t next_ = 0;
  std::string problem_;
};

ScriptAction sizeStep(Words& words) {
  const std::string what = "WIDTH HEIGHT, 1 to " + std::to_string(kWidestWindow) + " pixels";
  const auto width = static_cast<int>(words.count(what, 1, kWidestWindow));
  const auto height = static_cast<int>(words.count(what, 1, kWidestWindow));
  return SizeStep{{width, height}};
}

double timeoutIn(Words& words) {
  return words.number("a timeout of 0 to 600 seconds", 0, kLongestWait);
}

ScriptAction waitState(Words& words) {
  constexpr std::array<std::string_view, 6> kStates = {"connecting", "refining", "settled",
                                                       "complete",   "degraded", "limit-reached"};
  const std::string what =
      "a state: connecting, refining, settled, complete, degraded or limit-reached";
  std::string state = words.word(what);
  if (!state.empty() && std::find(kStates.begin(), kStates.end(), state) == kStates.end()) {
    words.wrongWord(what, state);
  }
  std::replace(state.begin(), state.end(), '-', ' ');
  const double timeout = timeoutIn(words);
  return WaitUntilStep{
      {"state", StatusCondition::Operator::equal, std::move(state)}, timeout, kStateHolds};
}

StatusCondition conditionIn(Words& words) {
  using Operator = StatusCondition::Operator;
  constexpr std::array<std::pair<std::string_view, Operator>, 7> kOperators = {
      {{"==", Operator::equal},
       {"!=", Operator::unequal},
       {"<", Operator::less},
       {"<=", Operator::atMost},
       {">", Operator::greater},
       {">=", Operator::atLeast},
       {"contains", Operator::contains}}};
  StatusCondition condition;
  condition.field = words.word("a field of the status, such as state or picks.0.node");
  const std::string is = words.word("one of == != < <= > >= contains");
  const auto* found = std::find_if(kOperators.begin(), kOperators.end(),
                                   [&is](const auto& known) { return known.first == is; });
  if (found != kOperators.end()) {
    condition.is = found->second;
  } else if (!is.empty()) {
    words.wrongWord("one of == != < <= > >= contains", is);
  }
  condition.value = words.word("a value");
  return condition;
}

ScriptAction clickStep(Words& words, int clicks) {
  const glm::dvec2 place = words.place();
  const Modifiers with = clicks == 1 ? words.modifiersAtEnd() : Modifiers{};
  InputStep step{{PointerMoved{place}}};
  for (int i = 0; i < clicks; ++i) {
    step.events.emplace_back(PointerPressed{PointerButton::left, with});
    step.events.emplace_back(PointerReleased{PointerButton::left, with});
  }
  return step;
}

ScriptAction dragStep(Words& words) {
  DragStep step;
  step.from = words.place();
  step.to = words.place();
  step.button = words.button();
  step.modifiers = words.modifiersIfAny().value_or(Modifiers{});
  if (!words.atEnd())
    step.steps = words.count(
        "modifiers (shift, ctrl, alt, joined by +) or a number of moves, 1 to "
        "1000",
        1, 1000);
  return step;
}

ScriptAction scrollStep(Words& words) {
  const glm::dvec2 place = words.place();
  const double steps = words.number("steps of the wheel, -1000 to 1000", -kMostScroll, kMostScroll);
  return InputStep{{PointerMoved{place}, Scrolled{{0, steps}}}};
}

ScriptAction keyStep(Words& words) {
  const std::string what = "a key: " + std::string(kKeyNames);
  const std::string name = words.word(what);
  const auto key = keyNamed(name);
  if (!key && !name.empty()) words.wrongWord(what, name);
  return InputStep{{KeyPressed{key.value_or(Key::none), words.modifiersAtEnd()}}};
}

ScriptAction cameraStep(Words& words) {
  const std::string text = words.word("a camera, as --camera has it");
  auto spec = parseCameraSpec(text);
  if (!spec && !text.empty()) words.wrongWord("a camera (" + spec.error().message + ")", text);
  return CameraStep{spec.value_or(CameraSpec{})};
}

ScriptAction compareStep(Words& words) {
  CompareStep step;
  step.file = words.word("the name of a PNG file");
  const std::string what = "a tolerance: psnr:DB or mean:DIFFERENCE";
  const std::string text = words.word(what);
  const bool psnr = text.starts_with("psnr:");
  step.measure = psnr ? CompareStep::Measure::psnr : CompareStep::Measure::mean;
  Words number({text.size() > 5 ? text.substr(5) : ""});
  step.tolerance = number.number(what, 0, psnr ? 100 : 255);
  if (!text.empty() && ((!psnr && !text.starts_with("mean:")) || !number.problem().empty())) {
    words.wrongWord(what, text);
  }
  return step;
}

InputStep buttonStep(Words& words, bool down) {
  const PointerButton button = words.button();
  const Modifiers with = words.modifiersAtEnd();
  return down ? InputStep{{PointerPressed{button, with}}}
              : InputStep{{PointerReleased{button, with}}};
}

struct NamedStep {
  std::string_view name;
  ScriptAction (*read)(Words&);
};
const std::array<NamedStep, 21> kSteps = {{
    {"size", sizeStep},
    {"wait",
     [](Words& w) -> ScriptAction {
       return WaitStep{w.number("0 to 600 seconds", 0, kLongestWait)};
     }},
    {"wait-frames",
     [](Words& w) -> ScriptAction { return WaitFramesStep{w.count("1 to 100000", 1, 100'000)}; }},
    {"wait-state", waitState},
    {"wait-until",
     [](Words& w) -> ScriptAction {
       StatusCondition condition = conditionIn(w);
       return WaitUntilStep{std::move(condition), timeoutIn(w), 0};
     }},
    {"move", [](Words& w) -> ScriptAction { return InputStep{{PointerMoved{w.place()}}}; }},
    {"press", [](Words& w) -> ScriptAction { return buttonStep(w, true); }},
    {"release", [](Words& w) -> ScriptAction { return buttonStep(w, false); }},
    {"click", [](Words& w) { return clickStep(w, 1); }},
    {"double-click", [](Words& w) { return clickStep(w, 2); }},
    {"drag", dragStep},
    {"scroll", scrollStep},
    {"key", keyStep},
    {"pick", [](Words& w) -> ScriptAction { return PickStep{w.place()}; }},
    {"camera", cameraStep},
    {"screenshot",
     [](Words& w) -> ScriptAction { return ScreenshotStep{w.word("the name of a PNG file")}; }},
    {"picture",
     [](Words& w) -> ScriptAction { return PictureStep{w.word("the name of a PNG file")}; }},
    {"compare", compareStep},
    {"status", [](Words& w) -> ScriptAction { return StatusStep{w.word("the name of a file")}; }},
    {"expect", [](Words& w) -> ScriptAction { return ExpectStep{conditionIn(w)}; }},
    {"print", [](Words& w) -> ScriptAction { return PrintStep{w.word("a text")}; }},
}};

ScriptAction commandStep(Words& words) {
  return RunStep{words.word("a command in quotes")};
}

std::string stepNames() {
  std::string names;
  for (const NamedStep& step : kSteps) names += std::string(step.name) + ", ";
  return names + "run or quit";
}

Result<ScriptAction> actionOf(std::vector<std::string> words) {
  const std::string name = words.front();
  Words rest({words.begin() + 1, words.end()});
  const auto* known = std::find_if(kSteps.begin(), kSteps.end(),
                                   [&name](const NamedStep& step) { return step.name == name; });
  ScriptAction action = QuitStep{};
  if (known != kSteps.end()) {
    action = known->read(rest);
  } else if (name == "run") {
    action = commandStep(rest);
  } else if (name != "quit") {
    return fail("'" + name.substr(0, 100) + "' is no step; expected one of " + stepNames());
  }
  if (rest.problem().empty() && !rest.atEnd()) rest.expected("the end of the line");
  if (!rest.problem().empty()) return fail(name + ": " + rest.problem());
  return action;
}

}  // namespace

Result<std::vector<ScriptStep>> parseScript(std::string_view text, const std::string& name) {
  std::vector<ScriptStep> steps;
  uint32_t number = 0;
  while (!text.empty()) {
    const size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    ++number;
    const auto wrong = [&](const std::string& message) {
      return fail(name + ":" + std::to_string(number) + ": " + message);
    };
    if (line.find('\0') != std::string_view::npos) return wrong("this is no text");
    auto words = splitScriptLine(line);
    if (!words) return wrong(words.error().message);
    if (words->empty()) continue;
    if (steps.size() == kMaxScriptSteps)
      return wrong("more than " + std::to_string(kMaxScriptSteps) + " steps");
    auto action = actionOf(std::move(*words));
    if (!action) return wrong(action.error().message);
    if (line.ends_with('\r')) line.remove_suffix(1);
    steps.push_back(
        {number, std::string(line.substr(line.find_first_not_of(" \t"))), std::move(*action)});
  }
  if (steps.empty()) return fail(name + ": there is no step in it");
  return steps;
}

Result<std::vector<ScriptStep>> readScript(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return fail(ErrorCode::notFound, "cannot read the script " + file.string());
  std::string text;
  std::array<char, 1 << 16> block{};
  while (in.read(block.data(), block.size()) || in.gcount() > 0) {
    text.append(block.data(), static_cast<size_t>(in.gcount()));
    if (text.size() > kMaxScriptBytes)
      return fail(ErrorCode::tooLarge, file.string() + ": longer than 1 MiB");
  }
  if (in.bad()) return fail(ErrorCode::unavailable, "cannot read the script " + file.string());
  return parseScript(text, file.string());
}

}  // namespace meshfront
