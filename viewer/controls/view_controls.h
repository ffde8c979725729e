// What mouse and keys do to a view, apart from any window system: the window feeds it, tests too.
//
// left drag: orbit; middle, right or shift + left drag: pan; wheel: zoom to the cursor;
// F fit, R reset, S shading, W wireframe, C colours, H help, Q quit.
#pragma once

#include <glm/vec2.hpp>
#include <optional>

#include "shared/camera/bounds.h"
#include "shared/camera/camera.h"

namespace meshfront {

enum class PointerButton { left, middle, right };

class ViewControls {
 public:
  ViewControls(const Camera& start, const Bounds& bounds)
      : camera_(start), start_(start), bounds_(bounds) {}

  [[nodiscard]] const Camera& camera() const { return camera_; }
  [[nodiscard]] const Bounds& bounds() const { return bounds_; }
  [[nodiscard]] bool flatShading() const { return flatShading_; }
  [[nodiscard]] bool wireframe() const { return wireframe_; }
  [[nodiscard]] bool colours() const { return colours_; }
  [[nodiscard]] bool helpShown() const { return helpShown_; }
  [[nodiscard]] bool quitAsked() const { return quitAsked_; }
  void setFlatShading(bool on) { flatShading_ = on; }
  void setWireframe(bool on) { wireframe_ = on; }
  void setColours(bool on) { colours_ = on; }
  void fit(PixelSize picture) { fitTo(camera_, bounds_, picture.aspect()); }
  void reset() { camera_ = start_; }

  // Cursor places are pixels of the picture, x to the right and y downward from its upper left.
  void press(PointerButton button, bool shift, glm::dvec2 cursor);
  void release(PointerButton button);
  void move(glm::dvec2 cursor, PixelSize picture);
  // `steps` of the wheel, positive nearer. `depth` is the depth buffer's value under the cursor; 0
  // or none: zoom to the plane of the target.
  void scroll(double steps, glm::dvec2 cursor, PixelSize picture, std::optional<float> depth);
  // An upper-case letter; others are ignored.
  void key(char letter, PixelSize picture);

 private:
  enum class Drag { none, orbit, pan };

  Camera camera_;
  Camera start_;
  Bounds bounds_;
  Drag drag_ = Drag::none;
  PointerButton dragButton_ = PointerButton::left;
  glm::dvec2 last_{0};
  bool flatShading_ = false;
  bool wireframe_ = false;
  bool colours_ = true;
  bool helpShown_ = false;
  bool quitAsked_ = false;
};

}  // namespace meshfront
