// Whole files in and out of memory.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "shared/result.h"

namespace meshfront {

// Errors name the file: notFound, or unavailable if it cannot be read.
[[nodiscard]] Result<std::string> readFileBytes(const std::filesystem::path& path);

// Atomic: a temporary file beside `path`, fsync, rename, fsync of the folder. On an Error
// (unavailable, naming the file) `path` is as it was and the temporary file is gone.
[[nodiscard]] Result<void> replaceFileBytes(const std::filesystem::path& path,
                                            std::string_view content);

}  // namespace meshfront
