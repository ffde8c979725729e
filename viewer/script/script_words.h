// The words of a line of a script, taken from left to right.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shared/result.h"

namespace meshfront {

// Parted by blanks; "..." keeps blanks, with \" and \\ in it; # in front of a word begins a
// comment.
[[nodiscard]] Result<std::vector<std::string>> splitScriptLine(std::string_view line);

}  // namespace meshfront
