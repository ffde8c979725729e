// Plays a script on a window, a step a turn, without ever blocking a turn.
//
//   ScriptPlayer player(std::move(*readScript("tour.txt")), "tour.txt");
//   callbacks.turnEnd = [&] {
//     if (player.turn(stage) != ScriptPlayer::State::playing) ViewerWindow::stop();
//   };
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "viewer/picture/picture.h"
#include "viewer/script/script.h"

namespace meshfront {

// The window, as far as a script sees it.
class ScriptStage {
 public:
  virtual ~ScriptStage() = default;
  [[nodiscard]] virtual double seconds() const = 0;  // a steady clock
  virtual void inject(const InputEvent& event) = 0;
  virtual void resize(PixelSize size) = 0;
  // False while there is no scene that a camera could be placed by.
  virtual bool placeCamera(const CameraSpec& spec) = 0;
  [[nodiscard]] virtual std::string statusJson() = 0;
  // The view alone, as last drawn; none while there is no scene.
  [[nodiscard]] virtual std::optional<Picture> view() = 0;
  // With the panel; none in this turn: ask again in the next one.
  [[nodiscard]] virtual std::optional<Picture> screen() = 0;
};

class ScriptPlayer {
 public:
  enum class State : uint8_t { playing, finished, failed };

  // `name` stands in front of messages, as in parseScript().
  ScriptPlayer(std::vector<ScriptStep> steps, std::string name);
  ScriptPlayer(const ScriptPlayer&) = delete;
  ScriptPlayer& operator=(const ScriptPlayer&) = delete;
  ~ScriptPlayer();  // ends a command that still runs

  State turn(ScriptStage& stage);
  [[nodiscard]] State state() const { return state_; }
  // Of failed: "tour.txt:12: expect state == settled: it is refining".
  [[nodiscard]] const std::string& message() const { return message_; }

 private:
  struct Doer;
  // What a step came to in a turn.
  struct Outcome {
    enum class Kind : uint8_t { done, again, failed, quit };
    Kind kind = Kind::done;
    std::string message;
  };

  std::vector<ScriptStep> steps_;
  std::string name_;
  size_t next_ = 0;
  State state_ = State::playing;
  std::string message_;
  // Of the step that is under way.
  bool begun_ = false;
  double begunAt_ = 0;
  uint32_t turns_ = 0;
  std::optional<double> trueSince_;
  uint64_t picksBefore_ = 0;
  pid_t command_ = 0;
};

}  // namespace meshfront
