// A file name's extension, by which formats and compressions are told apart.
#pragma once

#include <filesystem>
#include <string>

namespace meshfront {

// With its dot, A-Z in lower case; empty if there is none.
[[nodiscard]] inline std::string lowerCaseExtension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

}  // namespace meshfront
