// --headless --path: plays a camera path without a window.
#pragma once

#include "viewer/view_options.h"

namespace meshfront {

// Draws, refines, writes; returns the exit code.
int runPath(const ViewOptions& options);

}  // namespace meshfront
