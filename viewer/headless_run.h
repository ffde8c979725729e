// The viewer without a window: refines until the stop condition holds, then writes what was asked
// for.
#pragma once

#include "viewer/view_options.h"

namespace meshfront {

// Prints the summary to stdout and what went wrong to stderr; the exit code: 0 if the stop
// condition was met and everything is written, else 1.
[[nodiscard]] int runHeadless(const ViewOptions& options);

}  // namespace meshfront
