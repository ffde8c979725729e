#include "viewer/script/script_player.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <utility>

#include "viewer/script/shell_command.h"
#include "viewer/script/status_condition.h"

namespace meshfront {
namespace {

constexpr double kResizeTimeout = 10;  // seconds
constexpr double kPictureTimeout = 10;
constexpr double kCommandTimeout = 60;

std::string secondsText(double seconds) {
  std::string text = std::to_string(seconds);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text + " s";
}

Result<void> writeText(const std::string& text, const std::filesystem::path& file) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out << text << '\n';
  out.close();
  if (out.fail()) return fail(ErrorCode::unavailable, "cannot write " + file.string());
  return {};
}

double meanDifference(const Picture& a, const Picture& b) {
  double sum = 0;
  for (size_t i = 0; i < a.rgb.size(); ++i) sum += std::abs(int{a.rgb[i]} - int{b.rgb[i]});
  return a.rgb.empty() ? 0 : sum / static_cast<double>(a.rgb.size());
}

}  // namespace

// What each step does in a turn.
struct ScriptPlayer::Doer {
  ScriptPlayer& player;
  ScriptStage& stage;
  using Kind = Outcome::Kind;

  static Outcome again() { return {Kind::again, {}}; }
  static Outcome failed(std::string why) { return {Kind::failed, std::move(why)}; }
  static Outcome outcomeOf(const Result<void>& result) {
    return result ? Outcome{} : failed(result.error().message);
  }
  [[nodiscard]] double since() const { return stage.seconds() - player.begunAt_; }
  [[nodiscard]] bool first() const { return player.turns_ == 0; }

  [[nodiscard]] uint64_t number(const char* field) const {
    const std::string found = testStatus({field, {}, ""}, stage.statusJson()).found;
    return std::strtoull(found.c_str(), nullptr, 10);
  }

  Outcome operator()(const SizeStep& step) const {
    if (first()) stage.resize(step.size);
    const bool there = number("picture_size.0") == static_cast<uint64_t>(step.size.width) &&
                       number("picture_size.1") == static_cast<uint64_t>(step.size.height);
    if (there) return {};
    if (since() < kResizeTimeout) return again();
    return failed("the window does not take this size; is the screen as large?");
  }
  Outcome operator()(const WaitStep& step) const {
    return since() >= step.seconds ? Outcome{} : again();
  }
  Outcome operator()(const WaitFramesStep& step) const {
    return player.turns_ >= step.turns ? Outcome{} : again();
  }
  Outcome operator()(const WaitUntilStep& step) const {
    const ConditionOutcome test = testStatus(step.condition, stage.statusJson());
    if (!test.holds) {
      player.trueSince_.reset();
      return since() < step.timeout
                 ? again()
                 : failed("after " + secondsText(step.timeout) + " it is " + test.found);
    }
    if (!player.trueSince_) player.trueSince_ = stage.seconds();
    return stage.seconds() - *player.trueSince_ >= step.holds ? Outcome{} : again();
  }
  Outcome operator()(const InputStep& step) const {
    for (const InputEvent& event : step.events) stage.inject(event);
    return {};
  }
  // Pressed in the first turn, moved in the next ones, let go in the last.
  Outcome operator()(const DragStep& step) const {
    const uint32_t turn = player.turns_;
    if (turn == 0) {
      stage.inject(PointerMoved{step.from});
      stage.inject(PointerPressed{step.button, step.modifiers});
      return again();
    }
    const double share = static_cast<double>(turn) / step.steps;
    stage.inject(PointerMoved{step.from + (step.to - step.from) * share});
    if (turn < step.steps) return again();
    stage.inject(PointerReleased{step.button, step.modifiers});
    return {};
  }
  Outcome operator()(const PickStep& step) const {
    if (first()) {
      player.picksBefore_ = number("picks_made");
      stage.inject(PointerMoved{step.place});
      stage.inject(PointerPressed{});
      stage.inject(PointerReleased{});
      return again();
    }
    if (number("picks_made") > player.picksBefore_) return {};
    return player.turns_ < 5 ? again() : failed("there is no surface");
  }
  Outcome operator()(const CameraStep& step) const {
    return stage.placeCamera(step.spec) ? Outcome{}
                                        : failed("there is no mesh yet that it could look at");
  }
  Outcome operator()(const ScreenshotStep& step) const {
    const auto picture = stage.screen();
    if (picture) return outcomeOf(writePng(*picture, step.file));
    return since() < kPictureTimeout ? again() : failed("nothing comes to the screen");
  }
  Outcome operator()(const PictureStep& step) const {
    const auto picture = stage.view();
    return picture ? outcomeOf(writePng(*picture, step.file)) : failed("there is no picture yet");
  }
  Outcome operator()(const CompareStep& step) const {
    const auto picture = stage.view();
    if (!picture) return failed("there is no picture yet");
    const auto other = readPng(step.file);
    if (!other) return failed(other.error().message);
    const auto psnr = peakSignalToNoise(*picture, *other);
    if (!psnr) return failed(psnr.error().message);
    const bool byPsnr = step.measure == CompareStep::Measure::psnr;
    const double found = byPsnr ? *psnr : meanDifference(*picture, *other);
    const bool holds = byPsnr ? found >= step.tolerance : found <= step.tolerance;
    return holds ? Outcome{} : failed("it is " + std::to_string(found) + (byPsnr ? " dB" : ""));
  }
  Outcome operator()(const StatusStep& step) const {
    return outcomeOf(writeText(stage.statusJson(), step.file));
  }
  Outcome operator()(const ExpectStep& step) const {
    const ConditionOutcome test = testStatus(step.condition, stage.statusJson());
    return test.holds ? Outcome{} : failed("it is " + test.found);
  }
  Outcome operator()(const PrintStep& step) const {
    std::fprintf(stderr, "%s\n", step.text.c_str());
    return {};
  }
  Outcome operator()(const RunStep& step) const {
    if (first()) {
      const auto started = startShellCommand(step.command);
      if (!started) return failed(started.error().message);
      player.command_ = *started;
    }
    const std::optional<int> status = shellCommandStatus(player.command_);
    if (!status && since() < kCommandTimeout) return again();
    if (!status) {
      endShellCommand(std::exchange(player.command_, 0));
      return failed("it has not ended after " + secondsText(kCommandTimeout));
    }
    player.command_ = 0;
    return *status == 0 ? Outcome{} : failed("it ended with status " + std::to_string(*status));
  }
  Outcome operator()(const QuitStep& /*step*/) const { return {Kind::quit, {}}; }
};

ScriptPlayer::ScriptPlayer(std::vector<ScriptStep> steps, std::string name)
    : steps_(std::move(steps)), name_(std::move(name)) {}

ScriptPlayer::~ScriptPlayer() {
  if (command_ != 0) endShellCommand(command_);
}

ScriptPlayer::State ScriptPlayer::turn(ScriptStage& stage) {
  if (state_ != State::playing) return state_;
  const ScriptStep& step = steps_.at(next_);
  if (!begun_) {
    begun_ = true;
    begunAt_ = stage.seconds();
    turns_ = 0;
    trueSince_.reset();
  }
  const Outcome outcome = std::visit(Doer{*this, stage}, step.action);
  ++turns_;
  switch (outcome.kind) {
    case Outcome::Kind::again:
      break;
    case Outcome::Kind::done:
      begun_ = false;
      if (++next_ == steps_.size()) state_ = State::finished;
      break;
    case Outcome::Kind::quit:
      state_ = State::finished;
      break;
    case Outcome::Kind::failed:
      state_ = State::failed;
      message_ =
          name_ + ":" + std::to_string(step.line) + ": " + step.text + ": " + outcome.message;
      break;
  }
  return state_;
}

}  // namespace meshfront
