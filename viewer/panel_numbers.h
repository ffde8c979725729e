// The window's panel, filled from what the refinement tells: rates and series need memory.
#pragma once

#include <span>

#include "shared/scene/scene_status.h"
#include "viewer/gl/mesh_renderer.h"
#include "viewer/view_options.h"
#include "viewer/window/panel_status.h"
#include "viewer/window/quality_series.h"

namespace meshfront {

class PanelNumbers {
 public:
  explicit PanelNumbers(const ViewOptions& options) : options_(options) {}

  // Often; `seconds` on a clock that does not go back.
  void observe(const SceneStatus& scene, double seconds);
  // Of what observe() was given last. `ranking`: seconds of a count, 0: not known.
  [[nodiscard]] PanelStatus status(double seconds, double ranking) const;

 private:
  [[nodiscard]] std::optional<WindowMessage> message(double seconds) const;

  const ViewOptions& options_;
  SceneStatus scene_;
  QualitySeries quality_;
  RateMeter splits_;
};

// Of a colouring, for the panel; empty for own colours and clay.
[[nodiscard]] Legend legendOf(Colouring colouring, unsigned finestLevel);

}  // namespace meshfront
