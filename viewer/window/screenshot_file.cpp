#include "viewer/window/screenshot_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>

namespace meshfront {

Result<std::filesystem::path> writeNumberedScreenshot(const Picture& picture,
                                                      const std::filesystem::path& folder) {
  constexpr int kMost = 9999;
  for (int number = 1; number <= kMost; ++number) {
    std::array<char, 32> name{};
    std::snprintf(name.data(), name.size(), "meshfront-%04d.png", number);
    std::filesystem::path path = folder / name.data();
    // Takes the name first: two viewers in one folder do not overwrite each other's.
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    if (file < 0 && errno == EEXIST) continue;
    if (file < 0) {
      return fail(ErrorCode::unavailable, "cannot write " + path.string() + ": " +
                                              std::generic_category().message(errno) +
                                              "; start the viewer in a folder of yours");
    }
    ::close(file);
    if (Result<void> written = writePng(picture, path); !written) {
      std::error_code ignored;
      std::filesystem::remove(path, ignored);
      return tl::unexpected(written.error());
    }
    return path;
  }
  return fail(ErrorCode::tooLarge, "there are 9999 screenshots in " + folder.string() + " already");
}

}  // namespace meshfront
