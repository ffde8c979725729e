// The viewer's window as a script sees it.
#pragma once

#include <optional>
#include <string>

#include "viewer/script/script_player.h"
#include "viewer/window/viewer_window.h"

namespace meshfront {

class WindowStage final : public ScriptStage {
 public:
  // The window must outlive it.
  explicit WindowStage(ViewerWindow& window) : window_(window) {}

  [[nodiscard]] double seconds() const override;
  void inject(const InputEvent& event) override { window_.inject(event); }
  void resize(PixelSize size) override { window_.resize(size); }
  bool placeCamera(const CameraSpec& spec) override;
  [[nodiscard]] std::string statusJson() override { return toJson(window_.status()); }
  [[nodiscard]] std::optional<Picture> view() override { return window_.readView(); }
  [[nodiscard]] std::optional<Picture> screen() override { return window_.readScreen(); }

 private:
  ViewerWindow& window_;
};

}  // namespace meshfront
