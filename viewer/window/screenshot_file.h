// Where a screenshot goes that nobody has named: meshfront-0001.png and so on.
#pragma once

#include <filesystem>

#include "shared/result.h"
#include "viewer/picture/picture.h"

namespace meshfront {

// Writes it under the first number that is free in `folder`; never over a file that is there.
[[nodiscard]] Result<std::filesystem::path> writeNumberedScreenshot(
    const Picture& picture, const std::filesystem::path& folder);

}  // namespace meshfront
