// Drawing without a display. These tests need an OpenGL 4.5 driver (Mesa's llvmpipe will do): where
// there is none they fail and say what to install.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <utility>

#include "viewer/gl/gl_context.h"
#include "viewer/gl/mesh_renderer.h"

namespace meshfront {

// Sees the square (0,0)-(1,1) of planeShape() exactly fill a square picture.
inline Camera planeCamera() {
  return {{0.5, 0.5, 1}, {0.5, 0.5, 0}, {0, 1, 0}, 2 * std::atan(0.5)};
}

class GlTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto context = GlContext::createHeadless();
    ASSERT_TRUE(context) << context.error().message;
    context_.emplace(std::move(*context));
  }
  void TearDown() override {
    if (context_) {
      EXPECT_EQ(takeGlErrors(), "");
    }
  }

  std::optional<GlContext> context_;  // outlives what fixtures that inherit hold
};

class DrawingTest : public GlTest {
 protected:
  explicit DrawingTest(PixelSize size) : size_(size) {}
  void SetUp() override {
    GlTest::SetUp();
    if (!context_) return;
    auto renderer = MeshRenderer::create();
    ASSERT_TRUE(renderer) << renderer.error().message;
    renderer_.emplace(std::move(*renderer));
    auto target = RenderTarget::create(size_);
    ASSERT_TRUE(target) << target.error().message;
    target_.emplace(std::move(*target));
  }
  void TearDown() override {
    GlTest::TearDown();
    if (renderer_) {
      EXPECT_EQ(renderer_->problem(), "");
    }
  }

  std::optional<MeshRenderer> renderer_;
  std::optional<RenderTarget> target_;

 private:
  PixelSize size_;
};

}  // namespace meshfront
