// The window on a display (Xvfb will do): what it shows is what is drawn without one, it follows a
// resize, draws again only when something changed, and ends when asked.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "tests/unit/generated_shapes.h"
#include "viewer/gl/pixel_counter.h"
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
  options.bounds = kBounds;
  options.idleWait = 0.01;
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

TEST(Window, ShowsCountsResizesAndEnds) {
  auto window = ViewerWindow::open(optionsFor({640, 480}));
  ASSERT_TRUE(window) << window.error().message;
  auto coarse = testing::sphereShape(2, 0.2);
  auto fine = testing::sphereShape(5, 0.2);
  auto counter = PixelCounter::create();

  const testing::GridShape* shape = &coarse;
  uint64_t change = 1;
  int pictures = 0;
  int viewChanges = 0;
  int turns = 0;
  Picture inTarget;
  Picture onScreen;
  std::vector<uint32_t> counts;
  PixelSize lastSize;

  WindowCallbacks callbacks;
  callbacks.mesh = [&] {
    return MeshArrays{shape->quantization, shape->positions, shape->triangles, change};
  };
  callbacks.status = [&] {
    return std::vector<std::string>{"triangles\t" + std::to_string(shape->triangles.size()),
                                    "received\t1,234 of 5,678 records"};
  };
  callbacks.drawn = [&](const DrawnView& view) {
    ++pictures;
    viewChanges += view.viewChanged ? 1 : 0;
    lastSize = view.target.size();
    inTarget = view.target.readPicture();
    counter.count(view.target, view.mesh, counts);
    EXPECT_EQ(counts.size(), shape->positions.size());
  };
  callbacks.composed = [&] {
    if (turns == 7) {
      onScreen = window->readScreen();
    }
  };
  callbacks.finished = [&] {
    ++turns;
    if (turns == 5) {
      EXPECT_EQ(pictures, 1);  // nothing changed since the first
      shape = &fine;
      ++change;
    }
    if (turns == 8) {
      EXPECT_EQ(pictures, 2);
      EXPECT_EQ(viewChanges, 1);
      if (const char* path = std::getenv("MESHFRONT_WINDOW_PICTURE")) {
        EXPECT_TRUE(writePng(onScreen, path));
      }
      EXPECT_EQ(onScreen.width, 640);
      // The panel covers the upper left; the lower right quarter is the mesh alone.
      EXPECT_EQ(lowerRightQuarter(onScreen), lowerRightQuarter(inTarget));
      EXPECT_NE(onScreen, inTarget);  // there is a panel
      window->resize({500, 400});
    }
    return lastSize == PixelSize{500, 400} || turns > 500;
  };
  const auto ended = window->run(callbacks);
  EXPECT_TRUE(ended) << ended.error().message;
  EXPECT_EQ(lastSize, (PixelSize{500, 400}));
  EXPECT_EQ(takeGlErrors(), "");
}

TEST(Window, StopsWhenAnotherThreadSaysSo) {
  auto options = optionsFor({200, 150});
  options.idleWait = 60;  // only wake() can end a wait in time
  auto window = ViewerWindow::open(options);
  ASSERT_TRUE(window) << window.error().message;
  const auto shape = testing::sphereShape(2);
  std::atomic<bool> drawn{false};
  WindowCallbacks callbacks;
  callbacks.mesh = [&] {
    return MeshArrays{shape.quantization, shape.positions, shape.triangles, 1};
  };
  callbacks.drawn = [&](const DrawnView&) { drawn = true; };
  std::thread other([&] {
    while (!drawn) {
      ViewerWindow::wake();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    ViewerWindow::stop();
    ViewerWindow::wake();
  });
  EXPECT_TRUE(window->run(callbacks));
  other.join();
}

TEST(Window, BadCornersEndTheRunWithAnError) {
  auto window = ViewerWindow::open(optionsFor({200, 150}));
  ASSERT_TRUE(window) << window.error().message;
  EXPECT_FALSE(ViewerWindow::open(optionsFor({200, 150})));  // one at a time
  auto shape = testing::sphereShape(1);
  shape.triangles[3][1] = 1000;
  WindowCallbacks callbacks;
  callbacks.mesh = [&] {
    return MeshArrays{shape.quantization, shape.positions, shape.triangles, 1};
  };
  EXPECT_FALSE(window->run(callbacks));
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
