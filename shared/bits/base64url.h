// base64url without padding (RFC 4648 section 5), the spelling of bitstrings in URLs.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/result.h"

namespace meshfront {

[[nodiscard]] std::string base64urlEncode(std::span<const uint8_t> bytes);

// Strict: refuses padding, other alphabets, an impossible length and non-zero spare bits, so that
// one byte string has exactly one spelling.
[[nodiscard]] Result<std::vector<uint8_t>> base64urlDecode(std::string_view text);

}  // namespace meshfront
