// What lies over the picture beside the panel: help, messages, picked points, a short note. All
// draw by Dear ImGui, between Gui::begin() and end().
#pragma once

#include "shared/camera/camera.h"
#include "viewer/window/panel_status.h"

namespace meshfront {

// The list of controls on a darkened picture; a click outside closes it (returns false then).
[[nodiscard]] bool drawHelp(PixelSize picture);
// In the middle where there is no picture yet, else in its upper right corner.
void drawMessage(const WindowMessage& message, PixelSize picture, bool inTheMiddle);
// Marks on the surface, and the bar of numbers at the bottom.
void drawPicks(const PanelStatus& status, const Projection& projection, PixelSize picture);
// At the bottom, for a moment.
void drawNote(const std::string& note, PixelSize picture, bool abovePicks);

}  // namespace meshfront
