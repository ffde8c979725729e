// The window on a display (Xvfb will do): it opens before there is anything to see, what it then
// shows is what is drawn without one, it follows a resize and a hand, draws again only when
// something changed, and ends when asked.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <optional>
#include <thread>
#include <utility>

#include "tests/unit/generated_shapes.h"
#include "viewer/gl/gpu_mesh.h"
#include "viewer/gl/mesh_renderer.h"
#include "viewer/window/viewer_window.h"

namespace meshfront {
namespace {

// GLFW unloads the GL driver at the end, and a leak checker would take what the driver then still
// holds for lost. EGL displays stay: a first context without a window keeps the driver loaded.
const bool kDriverKept = GlContext::createHeadless().has_value();

const Bounds kBounds{{-1.2, -1.2, -1.2}, {1.2, 1.2, 1.2}};

WindowOptions optionsFor(PixelSize size) {
  WindowOptions options;
  options.size = size;
  options.busyWait = 0.01;
  return options;
}

std::vector<uint8_t> lowerRightQuarter(const Picture& picture) {
  std::vector<uint8_t> bytes;
  const auto width = static_cast<std::ptrdiff_t>(picture.width);
  for (std::ptrdiff_t y = picture.height / 2; y < picture.height; ++y) {
    const auto row = picture.rgb.begin() + 3 * width * y;
    bytes.insert(bytes.end(), row + 3 * (width / 2), row + 3 * width);
  }
  return bytes;
}

TEST(Window, DriverIsThere) {
  EXPECT_TRUE(kDriverKept);
}

// Draws a shape as the viewer draws a mesh.
struct DrawnShape {
  testing::GridShape shape = testing::sphereShape(2, 0.2);
  uint64_t change = 1;
  uint64_t drawnChange = 0;
  MeshRenderer renderer = std::move(*MeshRenderer::create());
  GpuMesh mesh;
  int pictures = 0;
  int viewChanges = 0;
  PixelSize lastSize;
  Picture inTarget;

  SceneTurn turn() const { return {drawnChange != change, false, true}; }
  Result<void> draw(const ViewToDraw& view) {
    const auto uploaded =
        mesh.update({shape.quantization, shape.positions, shape.triangles, change});
    if (!uploaded) return tl::unexpected(uploaded.error());
    renderer.draw(view.target, mesh, view.camera, view.bounds, {});
    drawnChange = change;
    ++pictures;
    viewChanges += view.viewChanged ? 1 : 0;
    lastSize = view.target.size();
    inTarget = view.target.readPicture();
    return {};
  }
  [[nodiscard]] WindowCallbacks callbacks() {
    WindowCallbacks calls;
    calls.turn = [this] { return turn(); };
    calls.draw = [this](const ViewToDraw& view) { return draw(view); };
    calls.status = [this] { return status(); };
    return calls;
  }
  // Everything that the panel can show.
  [[nodiscard]] PanelStatus status() const {
    PanelStatus status;
    status.state = "degraded";
    status.reason = "no answer from a server";
    status.retryIn = 3;
    status.trianglesShown = shape.triangles.size();
    status.trianglesHeld = 123'456;
    status.trianglesOfMesh = 1'234'567;
    status.recordsOfMesh = 5678;
    status.triangleBudget = {150'000, 200'000};
    status.byteBudget = {800'000'000, 1'000'000'000};
    status.splitsPerSecond = 45'678;
    status.bitsPerSplit = 28.3;
    status.cacheShare = 0.42;
    status.roundTrip = 0.032;
    status.rankingTime = 0.0042;
    status.quality = {{0, 0.1}, {1, 0.5}, {2, 0.6}, {3, 0.97}};
    status.meshes = {{"bunny", "settled", 1000, 69'451, ""},
                     {"igea", "degraded", 2000, 268'686, "no answer"}};
    status.legend = {
        "level",
        {{{0.2F, 0.1F, 0.5F}, "0"}, {{0.1F, 0.6F, 0.6F}, ""}, {{0.95F, 0.9F, 0.2F}, "17"}},
        true};
    return status;
  }
};

TEST(Window, ShowsAMessageThenTheSceneResizesAndEnds) {
  auto window = ViewerWindow::open(optionsFor({640, 480}));
  ASSERT_TRUE(window) << window.error().message;
  DrawnShape drawn;
  int turns = 0;
  std::optional<Picture> message;
  std::optional<Picture> onScreen;
  WindowCallbacks callbacks = drawn.callbacks();
  callbacks.status = [&, shown = callbacks.status] {
    PanelStatus status = shown();
    if (drawn.pictures == 0) status.message = WindowMessage{"Connecting ...", "to", "wait"};
    return status;
  };
  callbacks.turnEnd = [&] {
    ++turns;
    if (!message) {
      if (turns < 5) return;  // ImGui finds sizes in its first frames
      message = window->readScreen();
      EXPECT_FALSE(window->readView());
      EXPECT_EQ(drawn.pictures, 0);  // there is no scene
      if (message) {
        window->setScene({kBounds, false});
        turns = 0;
      }
      return;
    }
    if (turns == 10) {
      EXPECT_EQ(drawn.pictures, 1);  // nothing changed since the first
      drawn.shape = testing::sphereShape(5, 0.2);
      ++drawn.change;
    }
    if (turns >= 15 && !onScreen) {
      EXPECT_EQ(drawn.pictures, 2);
      EXPECT_EQ(drawn.viewChanges, 1);
      onScreen = window->readScreen();
      if (onScreen) window->resize({500, 400});
    }
  };
  callbacks.finished = [&] { return drawn.lastSize == PixelSize{500, 400} || turns > 500; };
  const auto ended = window->run(callbacks);
  ASSERT_TRUE(ended) << ended.error().message;
  EXPECT_EQ(drawn.lastSize, (PixelSize{500, 400}));
  ASSERT_TRUE(message && onScreen);
  if (const char* path = std::getenv("MESHFRONT_WINDOW_PICTURE")) {
    EXPECT_TRUE(writePng(*onScreen, path));
  }
  // Something in the middle, nothing in the corner.
  const auto pixel = [&](const Picture& picture, int x, int y) {
    return picture.rgb.at(
        3 * (static_cast<size_t>(y) * static_cast<size_t>(picture.width) + static_cast<size_t>(x)));
  };
  EXPECT_LT(pixel(*message, 320, 212), 100);
  EXPECT_GT(pixel(*message, 5, 5), 200);
  EXPECT_EQ(takeGlErrors(), "");
}

TEST(Window, PanelLiesOverThePictureAndCanBeHidden) {
  auto window = ViewerWindow::open(optionsFor({640, 480}));
  ASSERT_TRUE(window) << window.error().message;
  window->setScene({kBounds, false});
  DrawnShape drawn;
  std::optional<Picture> with;
  std::optional<Picture> without;
  int turns = 0;
  WindowCallbacks callbacks = drawn.callbacks();
  callbacks.turnEnd = [&] {
    if (++turns < 6) return;
    if (!with) {
      with = window->readScreen();
      if (!with) return;
      window->inject(KeyPressed{letterKey('P'), {}});
      turns = 0;
      return;
    }
    if (!without) without = window->readScreen();
  };
  callbacks.finished = [&] { return without.has_value(); };
  ASSERT_TRUE(window->run(callbacks));
  EXPECT_EQ(*without, drawn.inTarget);
  EXPECT_NE(*with, drawn.inTarget);
  // The panel covers the upper left; the lower right quarter is the mesh alone.
  EXPECT_EQ(lowerRightQuarter(*with), lowerRightQuarter(drawn.inTarget));
  EXPECT_FALSE(window->status().panelShown);
}

TEST(Window, TakesInputAsAPersonGivesIt) {
  auto window = ViewerWindow::open(optionsFor({640, 480}));
  ASSERT_TRUE(window) << window.error().message;
  window->setScene({kBounds, false});
  DrawnShape drawn;
  WindowCallbacks callbacks = drawn.callbacks();
  callbacks.pick = [](const SurfacePlace& place) {
    PickedPoint point;
    point.node = "3:01";
    point.decimals = 3;
    EXPECT_LT(glm::length(place.world), 1.3);
    return point;
  };
  std::string said;
  callbacks.say = [&said](const std::string& text) { said = text; };
  callbacks.refineHere = [](const SurfacePlace&) { return std::string("raised"); };
  std::vector<InputEvent> events{PointerMoved{{390, 240}},
                                 PointerPressed{},
                                 PointerReleased{},
                                 Scrolled{{0, 2}},
                                 PointerMoved{{350, 300}},
                                 PointerPressed{},
                                 PointerReleased{},
                                 KeyPressed{letterKey('X'), {}},
                                 KeyPressed{letterKey('C'), {false, true, false}},
                                 KeyPressed{letterKey('H'), {}}};
  const Camera start = window->camera();
  int turns = 0;
  callbacks.turnEnd = [&] {
    if (++turns > 2 && static_cast<size_t>(turns - 3) < events.size())
      window->inject(events.at(static_cast<size_t>(turns - 3)));
  };
  callbacks.finished = [&] { return static_cast<size_t>(turns) > events.size() + 6; };
  ASSERT_TRUE(window->run(callbacks));
  const PanelStatus status = window->status();
  ASSERT_EQ(status.picks.size(), 2U);
  EXPECT_EQ(status.picks[0].node, "3:01");
  EXPECT_GT(*status.pickDistance, 0.1);
  EXPECT_NE(window->camera(), start);
  EXPECT_EQ(said, "--camera '" + formatCamera(window->camera()) + "'");
  EXPECT_TRUE(status.helpShown);
  EXPECT_GT(status.picturesDrawn, 1U);
  EXPECT_TRUE(status.frame.has_value());
}

TEST(Window, StopsWhenAnotherThreadSaysSo) {
  auto options = optionsFor({200, 150});
  options.busyWait = 60;  // only wake() can end a wait in time
  auto window = ViewerWindow::open(options);
  ASSERT_TRUE(window) << window.error().message;
  window->setScene({kBounds, false});
  DrawnShape drawn;
  WindowCallbacks callbacks = drawn.callbacks();
  std::atomic<bool> isDrawn{false};
  callbacks.turnEnd = [&] { isDrawn = drawn.pictures > 0; };
  std::thread other([&] {
    while (!isDrawn) {
      ViewerWindow::wake();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    ViewerWindow::stop();
    ViewerWindow::wake();
  });
  EXPECT_TRUE(window->run(callbacks));
  other.join();
}

TEST(Window, AnErrorOfDrawingEndsTheRun) {
  auto window = ViewerWindow::open(optionsFor({200, 150}));
  ASSERT_TRUE(window) << window.error().message;
  EXPECT_FALSE(ViewerWindow::open(optionsFor({200, 150})));  // one at a time
  window->setScene({kBounds, false});
  DrawnShape drawn;
  drawn.shape.triangles[3][1] = 1000;
  EXPECT_FALSE(window->run(drawn.callbacks()));
}

TEST(WindowWithoutDisplay, SaysWhatToDo) {
  const char* set = std::getenv("DISPLAY");
  const std::string display = set == nullptr ? "" : set;
  setenv("DISPLAY", ":7777", 1);
  const auto window = ViewerWindow::open(optionsFor({200, 150}));
  setenv("DISPLAY", display.c_str(), 1);
  ASSERT_FALSE(window);
  EXPECT_NE(window.error().message.find("--headless"), std::string::npos);
}

}  // namespace
}  // namespace meshfront
