#include "viewer/script/script.h"

#include <gtest/gtest.h>

#include <deque>
#include <fstream>

#include "tests/data/temporary_folder.h"
#include "viewer/script/script_player.h"
#include "viewer/script/script_words.h"
#include "viewer/script/status_condition.h"

namespace meshfront {
namespace {

std::vector<ScriptStep> stepsOf(std::string_view text) {
  auto steps = parseScript(text, "tour");
  EXPECT_TRUE(steps) << steps.error().message;
  return steps.value_or(std::vector<ScriptStep>{});
}

std::string parsingError(std::string_view text) {
  const auto steps = parseScript(text, "tour");
  return steps ? "" : steps.error().message;
}

TEST(ScriptWords, KeepBlanksInQuotesAndLeaveOutComments) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(*splitScriptLine("  a\tb  \"c d\" # e"), (Words{"a", "b", "c d"}));
  EXPECT_EQ(*splitScriptLine(R"("say \"x\" \\ y" z#1)"), (Words{"say \"x\" \\ y", "z#1"}));
  EXPECT_EQ(*splitScriptLine("\"\""), Words{""});
  EXPECT_TRUE(splitScriptLine("# all")->empty());
  for (const char* wrong : {"\"open", "\"a\"b", R"("\n")", "\"a\\"}) {
    EXPECT_FALSE(splitScriptLine(wrong)) << wrong;
  }
}

TEST(Script, ReadsEveryStep) {
  const auto steps = stepsOf(
      "# a tour\n"
      "size 640 480\r\n"
      "wait 0.5\n\n"
      "wait-frames 3\n"
      "wait-state limit-reached 20\n"
      "wait-until message.title contains \"is away\" 5\n"
      "move 1 2\n"
      "press left shift+alt\n"
      "release left\n"
      "click 3.5 4 ctrl\n"
      "double-click 5 6\n"
      "drag 1 2 30 40 middle\n"
      "drag 1 2 30 40 left ctrl 25\n"
      "drag 1 2 30 40 left 4\n"
      "scroll 10 20 -0.25\n"
      "key f12\n"
      "key ]\n"
      "pick 7 8\n"
      "camera \"azimuth=30; elevation=10\"\n"
      "screenshot a.png\n"
      "picture \"b c.png\"\n"
      "compare a.png psnr:31.5\n"
      "compare a.png mean:2\n"
      "status s.json\n"
      "expect picks.0.world.2 >= 0.1\n"
      "print hello\n"
      "run \"true && true\"\n"
      "  quit");
  ASSERT_EQ(steps.size(), 27U);
  EXPECT_EQ(steps[0].line, 2U);
  EXPECT_EQ(steps[0].text, "size 640 480");
  EXPECT_EQ(steps[26].text, "quit");
  EXPECT_EQ(std::get<SizeStep>(steps[0].action).size, (PixelSize{640, 480}));
  EXPECT_EQ(std::get<WaitUntilStep>(steps[3].action).condition.value, "limit reached");
  EXPECT_EQ(std::get<WaitUntilStep>(steps[4].action).timeout, 5);
  const auto& press = std::get<InputStep>(steps[6].action);
  EXPECT_EQ(std::get<PointerPressed>(press.events.at(0)).modifiers, (Modifiers{true, false, true}));
  EXPECT_EQ(std::get<InputStep>(steps[8].action).events.size(), 3U);
  EXPECT_EQ(std::get<InputStep>(steps[9].action).events.size(), 5U);
  EXPECT_EQ(std::get<DragStep>(steps[10].action).steps, 10U);
  EXPECT_EQ(std::get<DragStep>(steps[11].action).steps, 25U);
  EXPECT_TRUE(std::get<DragStep>(steps[11].action).modifiers.control);
  EXPECT_EQ(std::get<DragStep>(steps[12].action).steps, 4U);
  EXPECT_EQ(std::get<Scrolled>(std::get<InputStep>(steps[13].action).events.at(1)).steps.y, -0.25);
  EXPECT_EQ(std::get<KeyPressed>(std::get<InputStep>(steps[14].action).events.at(0)).key, Key::f12);
  EXPECT_EQ(std::get<CameraStep>(steps[17].action).spec.elevation, 10);
  EXPECT_EQ(std::get<CompareStep>(steps[20].action).measure, CompareStep::Measure::psnr);
  EXPECT_EQ(std::get<CompareStep>(steps[21].action).tolerance, 2);
  EXPECT_EQ(std::get<ExpectStep>(steps[23].action).condition.is,
            StatusCondition::Operator::atLeast);
  EXPECT_EQ(std::get<RunStep>(steps[25].action).command, "true && true");
}

TEST(Script, ErrorsNameTheLineAndWhatMayStandThere) {
  const std::pair<const char*, const char*> wrong[] = {
      {"size 640", "tour:1: size: expected WIDTH HEIGHT"},
      {"quit\nsize 0 5", "tour:2:"},
      {"size 1.5 5", "WIDTH HEIGHT"},
      {"wiat 3", "'wiat' is no step; expected one of size, wait"},
      {"wait -1", "0 to 600 seconds"},
      {"wait nan", "0 to 600 seconds"},
      {"wait 1 2", "the end of the line, not '2'"},
      {"wait-state done 3", "connecting, refining, settled"},
      {"wait-state settled", "a timeout"},
      {"press up", "left, middle or right"},
      {"press left shift+super", "shift, ctrl, alt"},
      {"drag 1 2 3 left", "a place X Y"},
      {"drag 1 2 3 4 left 0", "1 to 1000"},
      {"drag 1 2 3 4 left shift 2.5", "1 to 1000"},
      {"move 1e9 2", "a place X Y"},
      {"key F7", "A to Z"},
      {"camera zoom=0", "zoom=FACTOR"},
      {"camera", "as --camera has it"},
      {"compare a.png 3", "psnr:DB"},
      {"compare a.png mean:300", "psnr:DB"},
      {"compare a.png psnr:", "psnr:DB"},
      {"expect state is settled", "== != <"},
      {"expect state ==", "a value"},
      {"screenshot", "PNG"},
      {"run \"echo", "closing quotes"},
      {"print \"a", "closing quotes"},
      {"", "no step"},
      {"# nothing", "no step"},
  };
  for (const auto& [text, part] : wrong) {
    EXPECT_NE(parsingError(text).find(part), std::string::npos)
        << text << ": " << parsingError(text);
  }
  EXPECT_NE(parsingError(std::string_view("wait 1\0", 7)).find("no text"), std::string::npos);
}

TEST(Script, FilesAreBounded) {
  const TemporaryFolder folder;
  EXPECT_FALSE(readScript(folder / "none"));
  EXPECT_FALSE(readScript(folder.path()));
  std::ofstream(folder / "long") << std::string(kMaxScriptBytes + 1, '\n');
  EXPECT_FALSE(readScript(folder / "long"));
  std::ofstream(folder / "fine") << "quit\n";
  EXPECT_TRUE(readScript(folder / "fine"));
}

TEST(StatusCondition, ComparesNumbersTextAndLists) {
  const std::string json =
      R"({"state":"settled","n":12.5,"ok":true,"none":null,"list":[{"x":[1,2,3]},{}]})";
  const auto holds = [&json](const char* text) {
    const auto steps = stepsOf(std::string("expect ") + text);
    return testStatus(std::get<ExpectStep>(steps.at(0).action).condition, json).holds;
  };
  for (const char* yes :
       {"state == settled", "state != refining", "state contains ettle", "n == 12.5", "n < 13",
        "n >= 12.5", "n > 2", "ok == true", "none == null", "list.size == 2", "list.0.x.2 == 3",
        "list.0.x.size > 2", "n contains 12"})
    EXPECT_TRUE(holds(yes)) << yes;
  for (const char* no : {"state == Settled", "n > 12.5", "n == abc", "missing == 1", "list.2 == 1",
                         "list.x == 1", "list.-1 == 1", "state.x == 1", "state > 3", "n. == 1"})
    EXPECT_FALSE(holds(no)) << no;
  EXPECT_FALSE(testStatus({"state", {}, "x"}, "no json").holds);
}

// A stage without a window.
class ListedStage final : public ScriptStage {
 public:
  double now = 0;
  std::vector<InputEvent> events;
  std::string status = R"({"state":"refining","picture_size":[0,0],"picks_made":0})";
  std::optional<Picture> shown = Picture{1, 1, {10, 20, 30}};
  int turnsToScreen = 2;

  [[nodiscard]] double seconds() const override { return now; }
  void inject(const InputEvent& event) override { events.push_back(event); }
  void resize(PixelSize size) override {
    status = R"({"picture_size":[)" + std::to_string(size.width) + "," +
             std::to_string(size.height) + "]}";
  }
  bool placeCamera(const CameraSpec& /*spec*/) override { return shown.has_value(); }
  [[nodiscard]] std::string statusJson() override { return status; }
  [[nodiscard]] std::optional<Picture> view() override { return shown; }
  [[nodiscard]] std::optional<Picture> screen() override {
    return --turnsToScreen < 0 ? shown : std::nullopt;
  }
};

// Plays to the end; turns are a tenth of a second.
std::string play(const std::string& text, ListedStage& stage, int* turns = nullptr) {
  ScriptPlayer player(stepsOf(text), "tour");
  int count = 0;
  while (player.turn(stage) == ScriptPlayer::State::playing && ++count < 10'000) stage.now += 0.1;
  if (turns != nullptr) *turns = count;
  return player.state() == ScriptPlayer::State::finished ? "" : player.message();
}

TEST(ScriptPlayer, GoesAStepATurnAndWaits) {
  ListedStage stage;
  int turns = 0;
  EXPECT_EQ(play("move 1 2\nwait 1\nwait-frames 5\nkey F\nquit\nkey S", stage, &turns), "");
  EXPECT_EQ(stage.events.size(), 2U);
  EXPECT_GE(turns, 15);
  EXPECT_LE(turns, 25);
}

TEST(ScriptPlayer, DragsWithOneMoveATurn) {
  ListedStage stage;
  EXPECT_EQ(play("drag 0 0 40 20 left shift 4", stage), "");
  ASSERT_EQ(stage.events.size(), 7U);
  EXPECT_TRUE(std::get<PointerPressed>(stage.events[1]).modifiers.shift);
  EXPECT_EQ(std::get<PointerMoved>(stage.events[3]).place, glm::dvec2(20, 10));
  EXPECT_EQ(std::get<PointerMoved>(stage.events[5]).place, glm::dvec2(40, 20));
  EXPECT_TRUE(std::holds_alternative<PointerReleased>(stage.events[6]));
}

TEST(ScriptPlayer, FailsWhereAnExpectationDoes) {
  ListedStage stage;
  EXPECT_EQ(play("wait 0\nexpect state == settled", stage),
            "tour:2: expect state == settled: it is refining");
  EXPECT_EQ(play("wait-state settled 2", stage),
            "tour:1: wait-state settled 2: after 2 s it is refining");
  EXPECT_NE(play("pick 3 4", stage).find("no surface"), std::string::npos);
  stage.shown.reset();
  EXPECT_NE(play("picture x.png", stage).find("no picture yet"), std::string::npos);
  EXPECT_NE(play("camera whole", stage).find("no mesh yet"), std::string::npos);
}

TEST(ScriptPlayer, StatesMustHoldForAMoment) {
  ListedStage stage;
  ScriptPlayer player(stepsOf("wait-state settled 5"), "tour");
  const std::string refining = stage.status;
  const std::string settled = R"({"state":"settled"})";
  for (const auto& [status, expected] : std::deque<std::pair<std::string, ScriptPlayer::State>>{
           {settled, ScriptPlayer::State::playing},  // as of before
           {refining, ScriptPlayer::State::playing},
           {settled, ScriptPlayer::State::playing},
           {settled, ScriptPlayer::State::playing},
           {settled, ScriptPlayer::State::finished}}) {
    stage.status = status;
    EXPECT_EQ(player.turn(stage), expected);
    stage.now += 0.1;
  }
}

TEST(ScriptPlayer, WritesAndComparesPictures) {
  const TemporaryFolder folder;
  const std::string file = (folder / "a.png").string();
  ListedStage stage;
  EXPECT_EQ(
      play("screenshot " + file + "\ncompare " + file + " mean:0\ncompare " + file + " psnr:100",
           stage),
      "");
  EXPECT_LT(stage.turnsToScreen, 0);
  stage.shown = Picture{1, 1, {14, 20, 30}};
  EXPECT_EQ(play("compare " + file + " mean:2", stage), "");
  EXPECT_NE(play("compare " + file + " mean:1", stage).find("it is 1.33"), std::string::npos);
  EXPECT_NE(play("compare " + file + " psnr:50", stage).find(" dB"), std::string::npos);
  stage.shown = Picture{1, 2, {14, 20, 30, 1, 2, 3}};
  EXPECT_NE(play("compare " + file + " mean:255", stage).find("different sizes"),
            std::string::npos);
  EXPECT_NE(play("status " + (folder / "no/s.json").string(), stage).find("cannot write"),
            std::string::npos);
}

TEST(ScriptPlayer, RunsCommandsWithoutBlocking) {
  const TemporaryFolder folder;
  const std::string file = (folder / "made").string();
  ListedStage stage;
  const auto playRealTime = [&stage](const std::string& text) {
    ScriptPlayer player(stepsOf(text), "tour");
    while (player.turn(stage) == ScriptPlayer::State::playing) stage.now += 1e-5;
    return player.message();
  };
  EXPECT_EQ(playRealTime("run \"sleep 0.1; touch " + file + "\""), "");
  EXPECT_TRUE(std::filesystem::exists(file));
  EXPECT_NE(playRealTime("run \"exit 3\"").find("status 3"), std::string::npos);
  ScriptPlayer left(stepsOf("run \"sleep 1000\""), "tour");  // ended with the player
  EXPECT_EQ(left.turn(stage), ScriptPlayer::State::playing);
}

}  // namespace
}  // namespace meshfront
