// The panel over the picture: state, costs and gains, and a few buttons. Draws by Dear ImGui,
// between Gui::begin() and end().
#pragma once

#include "viewer/controls/view_controls.h"
#include "viewer/window/panel_status.h"

namespace meshfront {

// Buttons act on the controls.
void drawStatusPanel(const PanelStatus& status, ViewControls& controls, PixelSize picture);

}  // namespace meshfront
