#include "viewer/controls/view_controls.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "shared/camera/camera_spec.h"
#include "viewer/controls/control_lines.h"

namespace meshfront {
namespace {

const Bounds kControlledBox{{-1, -1, -1}, {1, 1, 1}};
constexpr PixelSize kWindow{800, 600};
constexpr Modifiers kShift{true, false, false};
constexpr Modifiers kControl{false, true, false};
constexpr Modifiers kAlt{false, false, true};

// Feeds controls as a person does.
struct Hand {
  ViewControls controls{placeCamera(*parseCameraSpec("whole"), kControlledBox, kWindow.aspect()),
                        kControlledBox};
  double now = 0;

  void give(const InputEvent& event) { controls.handle(event, kWindow, now); }
  void move(double x, double y) { give(PointerMoved{{x, y}}); }
  void drag(double x, double y, PointerButton button, Modifiers with) {
    give(PointerPressed{button, with});
    move(x, y);
    give(PointerReleased{button, with});
  }
  void click(double x, double y, Modifiers with = {}) {
    move(x, y);
    give(PointerPressed{PointerButton::left, with});
    give(PointerReleased{PointerButton::left, with});
  }
  void key(char letter, Modifiers with = {}) { give(KeyPressed{letterKey(letter), with}); }
  void key(Key code, Modifiers with = {}) { give(KeyPressed{code, with}); }
  [[nodiscard]] const Camera& camera() const { return controls.camera(); }
  [[nodiscard]] double distance() const { return glm::length(camera().eye - camera().target); }
};

// Pixels from the upper left.
glm::dvec2 pixelOf(const glm::dvec3& world, const Camera& camera) {
  const auto projection = Projection::fit(camera, kControlledBox, kWindow.aspect());
  const glm::dvec4 clip = projection.clipFrom(world) * glm::dvec4(0, 0, 0, 1);
  return {(clip.x / clip.w + 1) / 2 * kWindow.width, (1 - clip.y / clip.w) / 2 * kWindow.height};
}

TEST(Controls, LeftDragOrbits) {
  Hand hand;
  const Camera start = hand.camera();
  hand.move(100, 100);  // no button down
  EXPECT_EQ(hand.camera(), start);
  hand.drag(150, 120, PointerButton::left, {});
  EXPECT_EQ(hand.camera().target, start.target);
  EXPECT_GT(hand.camera().eye.y, start.eye.y);  // dragged down: seen from higher
  const Camera after = hand.camera();
  hand.move(300, 300);
  EXPECT_EQ(hand.camera(), after);
}

TEST(Controls, OtherButtonsAndShiftPan) {
  for (const auto& [button, with] :
       {std::pair{PointerButton::middle, Modifiers{}}, std::pair{PointerButton::right, Modifiers{}},
        std::pair{PointerButton::left, kShift}}) {
    Hand hand;
    const Camera before = hand.camera();
    hand.move(10, 10);
    hand.drag(30, 5, button, with);
    EXPECT_NE(hand.camera().target, before.target);
    EXPECT_LE(glm::length(hand.camera().eye - hand.camera().target - before.eye + before.target),
              1e-9);
  }
}

TEST(Controls, PanKeepsWhatIsGrabbedUnderThePointer) {
  Hand hand;
  const glm::dvec3 surface(0.4, 0.3, 0.9);
  hand.controls.setSurfaceProbe([&](glm::dvec2) { return surface; });
  const glm::dvec2 at = pixelOf(surface, hand.camera());
  hand.move(at.x, at.y);
  hand.drag(at.x + 70, at.y + 20, PointerButton::right, {});
  const glm::dvec2 now = pixelOf(surface, hand.camera());
  EXPECT_NEAR(now.x, at.x + 70, 1e-6);
  EXPECT_NEAR(now.y, at.y + 20, 1e-6);
}

TEST(Controls, ControlOrAltDragRolls) {
  for (const Modifiers with : {kControl, kAlt}) {
    Hand hand;
    const Camera before = hand.camera();
    hand.move(700, 300);                             // right of the middle
    hand.drag(400, 590, PointerButton::left, with);  // a quarter clockwise
    EXPECT_EQ(hand.camera().eye, before.eye);
    const glm::dvec3 above = before.target + viewAxes(before).upward * 0.1;
    const glm::dvec2 seen = pixelOf(above, hand.camera());
    EXPECT_GT(seen.x, kWindow.width / 2 + 5);
    EXPECT_NEAR(seen.y, kWindow.height / 2.0, 2);
  }
}

TEST(Controls, ASmallMoveIsAClickAndNoDrag) {
  Hand hand;
  const Camera start = hand.camera();
  hand.move(200, 200);
  hand.give(PointerPressed{});
  hand.move(202, 201);
  hand.give(PointerReleased{});
  EXPECT_EQ(hand.camera(), start);
  const auto commands = hand.controls.takeCommands();
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_EQ(commands[0].kind, ViewCommand::Kind::pick);
  EXPECT_EQ(commands[0].place, glm::dvec2(202, 201));
  EXPECT_TRUE(hand.controls.takeCommands().empty());  // each once
  hand.now = 5;
  hand.click(300, 300, kShift);
  EXPECT_EQ(hand.controls.takeCommands().at(0).kind, ViewCommand::Kind::measure);
  hand.now = 10;
  hand.move(10, 10);
  hand.drag(100, 100, PointerButton::left, {});
  EXPECT_TRUE(hand.controls.takeCommands().empty());
  // On a screen of twice the dots the same hand moves twice the pixels.
  hand.controls.setPixelScale(2);
  hand.now = 20;
  hand.move(10, 10);
  hand.drag(16, 10, PointerButton::left, {});
  EXPECT_EQ(hand.controls.takeCommands().size(), 1U);
}

TEST(Controls, DoubleClickCentresWhatIsThere) {
  Hand hand;
  const glm::dvec3 surface(0.5, 0.2, 0.8);
  hand.controls.setSurfaceProbe([&](glm::dvec2) { return surface; });
  const double before = glm::dot(surface - hand.camera().eye, viewAxes(hand.camera()).forward);
  hand.click(500, 200);
  hand.now += 0.2;
  hand.click(501, 201);
  const glm::dvec2 seen = pixelOf(surface, hand.camera());
  EXPECT_NEAR(seen.x, 400, 1e-6);
  EXPECT_NEAR(seen.y, 300, 1e-6);
  EXPECT_EQ(hand.camera().target, surface);
  EXPECT_NEAR(hand.distance(), before, 1e-9);          // of the same size
  EXPECT_EQ(hand.controls.takeCommands().size(), 1U);  // the first click's pick
  const Camera centred = hand.camera();
  hand.now += 3;
  hand.click(100, 100);
  hand.now += 1;  // too slow
  hand.click(100, 100);
  hand.now += 0.1;  // too far
  hand.click(300, 100);
  EXPECT_EQ(hand.camera(), centred);
}

TEST(Controls, WheelZoomsToTheSurfaceUnderThePointer) {
  Hand hand;
  const glm::dvec3 surface(0.5, 0.5, 0.5);
  const glm::dvec2 at = pixelOf(surface, hand.camera());
  int probed = 0;
  hand.controls.setSurfaceProbe([&](glm::dvec2 place) -> std::optional<glm::dvec3> {
    ++probed;
    EXPECT_EQ(place, at);
    return surface;
  });
  const double before = glm::length(hand.camera().eye - surface);
  hand.move(at.x, at.y);
  for (int i = 0; i < 3; ++i) hand.give(Scrolled{{0, 1}});
  EXPECT_EQ(probed, 1);  // the depth on the screen is of the first view only
  const glm::dvec2 after = pixelOf(surface, hand.camera());
  EXPECT_NEAR(after.x, at.x, 1e-6);
  EXPECT_NEAR(after.y, at.y, 1e-6);
  EXPECT_LT(glm::length(hand.camera().eye - surface), 0.7 * before);
  // Orbits turn about what one has gone to.
  const ViewAxes axes = viewAxes(hand.camera());
  EXPECT_NEAR(glm::dot(hand.camera().target - surface, axes.forward), 0, 1e-9);
}

TEST(Controls, FractionsOfAStepAddUpAndSidewaysIsNothing) {
  Hand whole;
  Hand parts;
  whole.move(400, 300);
  parts.move(400, 300);
  const Camera start = whole.camera();
  whole.give(Scrolled{{3, 0}});
  EXPECT_EQ(whole.camera(), start);
  whole.give(Scrolled{{0, 2}});
  for (int i = 0; i < 40; ++i) parts.give(Scrolled{{0.2, 0.05}});
  EXPECT_NEAR(whole.distance(), parts.distance(), 1e-9);
  EXPECT_LT(whole.distance(), 0.8 * glm::length(start.eye - start.target));
}

TEST(Controls, ZoomEndsAndComesBack) {
  Hand hand;
  hand.move(400, 300);
  const double start = hand.distance();
  for (int i = 0; i < 1000; ++i) hand.give(Scrolled{{0, -5}});
  EXPECT_LT(glm::length(hand.camera().eye), 1e4);
  EXPECT_GT(glm::length(hand.camera().eye), 100);
  for (int i = 0; i < 2000; ++i) hand.give(Scrolled{{0, 5}});
  EXPECT_GT(hand.distance(), 0);
  EXPECT_LT(hand.distance(), 0.01);
  for (int i = 0; i < 60; ++i) hand.give(Scrolled{{0, -2}});
  EXPECT_GT(hand.distance(), start);
}

TEST(Controls, ArrowsOrbitAndPanPlusAndMinusZoomBracketsRoll) {
  Hand hand;
  const Camera start = hand.camera();
  hand.key(Key::left);
  EXPECT_NE(hand.camera().eye, start.eye);
  EXPECT_EQ(hand.camera().target, start.target);
  hand.key(Key::right);
  EXPECT_LE(glm::length(hand.camera().eye - start.eye), 1e-9);
  hand.key(Key::up, kShift);
  EXPECT_NE(hand.camera().target, start.target);
  hand.key(Key::home);
  EXPECT_EQ(hand.camera(), start);
  const double before = hand.distance();
  hand.key(Key::plus);
  EXPECT_LT(hand.distance(), before);
  hand.key(Key::minus);
  EXPECT_NEAR(hand.distance(), before, 1e-9);
  hand.key(Key::rightBracket);
  EXPECT_NE(hand.camera().up, start.up);
  hand.key(Key::leftBracket);
  EXPECT_LE(glm::length(hand.camera().up - glm::normalize(start.up)), 1e-9);
}

TEST(Controls, KeysSwitch) {
  Hand hand;
  for (const char letter : {'S', 'W', 'B', 'G', 'P', 'H'}) hand.key(letter);
  const ViewSwitches all = hand.controls.switches();
  EXPECT_TRUE(all.flatShading && all.wireframe && all.missingBounds && all.help);
  EXPECT_FALSE(all.geomorph || all.panel);
  hand.key(Key::tab);
  hand.key(Key::f1);
  EXPECT_TRUE(hand.controls.switches().panel);
  EXPECT_FALSE(hand.controls.switches().help);
  hand.key(Key::question);
  EXPECT_TRUE(hand.controls.switches().help);
  EXPECT_FALSE(hand.controls.quitAsked());
  hand.key('Q');
  EXPECT_TRUE(hand.controls.quitAsked());
  hand.key('F');
  EXPECT_EQ(hand.camera().target, kControlledBox.center());
}

TEST(Controls, ColouringsGoRoundAndLeaveOutWhatLooksAlike) {
  Hand hand;
  std::vector<ColouringMode> seen;
  for (unsigned i = 0; i < kColourings; ++i) {
    hand.key('C');
    seen.push_back(hand.controls.switches().colouring);
  }
  EXPECT_EQ(seen, (std::vector{ColouringMode::clay, ColouringMode::tree, ColouringMode::level,
                               ColouringMode::pixels, ColouringMode::missing, ColouringMode::own}));
  hand.controls.setHasColours(false);
  hand.key('C');
  EXPECT_EQ(hand.controls.switches().colouring, ColouringMode::tree);
  hand.key('C', kShift);
  EXPECT_EQ(hand.controls.switches().colouring, ColouringMode::own);
}

TEST(Controls, CommandsOfKeys) {
  using Kind = ViewCommand::Kind;
  Hand hand;
  hand.move(30, 40);
  hand.key('X');
  hand.key(Key::f12);
  hand.key('S', kControl);
  hand.key('C', kControl);
  hand.key(Key::deleteKey);
  std::vector<Kind> kinds;
  for (const ViewCommand& command : hand.controls.takeCommands()) kinds.push_back(command.kind);
  EXPECT_EQ(kinds, (std::vector{Kind::refineHere, Kind::screenshot, Kind::screenshot,
                                Kind::copyCamera, Kind::clearPicks}));
  EXPECT_EQ(hand.controls.switches(), ViewSwitches{});  // Ctrl + S does not change the shading
}

TEST(Controls, AWindowWithoutPixelsChangesNothing) {
  Hand hand;
  const Camera start = hand.camera();
  hand.controls.handle(Scrolled{{0, 3}}, {0, 0}, 0);
  hand.controls.handle(PointerPressed{}, {0, 0}, 0);
  hand.controls.handle(PointerMoved{{500, 500}}, {0, 0}, 0);
  EXPECT_EQ(hand.camera(), start);
}

TEST(KeyNames, ReadWhatTheyWrite) {
  for (unsigned code = 1; code < 256; ++code) {
    const auto key = static_cast<Key>(code);
    const std::string name = keyName(key);
    if (name == "none") continue;
    EXPECT_EQ(keyNamed(name), key) << name;
  }
  EXPECT_EQ(keyNamed("a"), letterKey('A'));
  EXPECT_EQ(keyNamed("ESC"), Key::escape);
  EXPECT_EQ(keyNamed("f2"), std::nullopt);
  EXPECT_EQ(keyNamed(""), std::nullopt);
  EXPECT_EQ(keyNamed("1"), std::nullopt);
}

TEST(ControlLines, BeginWithAHeadingAndAreFilled) {
  EXPECT_TRUE(kControlLines.front().input.empty());
  for (const ControlLine& line : kControlLines) EXPECT_FALSE(line.meaning.empty());
}

}  // namespace
}  // namespace meshfront
