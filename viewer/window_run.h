// The viewer with a window: refines what is looked at until the window is closed.
#pragma once

#include "viewer/view_options.h"

namespace meshfront {

// Prints the summary to stdout and what went wrong to stderr; the exit code: 0 once the window is
// closed, 1 if the mesh or a window could not be had.
[[nodiscard]] int runWindow(const ViewOptions& options);

}  // namespace meshfront
