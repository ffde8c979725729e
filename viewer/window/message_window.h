// A window that says why there is no view, where even OpenGL 4.5 is missing.
#pragma once

#include <functional>
#include <string>

#include "shared/result.h"
#include "viewer/window/panel_status.h"

namespace meshfront {

// Until it is closed, a key pressed, or `finished` says so (asked some times a second). Needs
// OpenGL 3.0. An error where no window can be opened at all.
Result<void> showMessageWindow(const std::string& title, const WindowMessage& message,
                               const std::function<bool()>& finished);

}  // namespace meshfront
