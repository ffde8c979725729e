// CRC-32C (Castagnoli; RFC 3720 appendix B.4), the checksum that ends every base, chunk and answer.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/result.h"

namespace meshfront {

inline constexpr size_t kChecksumBytes = 4;

[[nodiscard]] uint32_t crc32c(std::span<const uint8_t> bytes, uint32_t previous = 0);

// Appends the checksum of `bytes` to it, little-endian.
void appendChecksum(std::vector<uint8_t>& bytes);

// The content in front of a right checksum; else an error that names `what`.
[[nodiscard]] Result<std::span<const uint8_t>> checkedContent(std::span<const uint8_t> bytes,
                                                              const char* what);

}  // namespace meshfront
