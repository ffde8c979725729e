// Compressed files in memory: gzip (RFC 1952), xz and Zstandard (RFC 8878).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "shared/result.h"

namespace meshfront {

enum class Compression { none, gzip, xz, zstd };

// By the first bytes.
[[nodiscard]] Compression compressionOf(std::string_view file);
// By the extension (.gz, .xz, .zst, any case).
[[nodiscard]] Compression compressionNamed(const std::filesystem::path& path);
[[nodiscard]] const char* nameOf(Compression compression);

// Untrusted: damage and a missing end are Errors that name the byte of the compressed file at which
// they were noticed; more than `limit` bytes are an Error (tooLarge) as soon as they come. Several
// files behind one another become one. Memory: twice what comes out, plus the window of the format
// (at most 128 MiB).
[[nodiscard]] Result<std::string> decompress(std::string_view file, Compression compression,
                                             uint64_t limit);

}  // namespace meshfront
