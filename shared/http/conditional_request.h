// If-None-Match (RFC 9110 section 13.1.2).
#pragma once

#include <string_view>

namespace meshfront {

// Whether the field's value - a list of entity tags, weak ones too, or * - matches the strong tag
// `etag` (with its quotes). Anything malformed ends the list.
[[nodiscard]] bool ifNoneMatchHolds(std::string_view field, std::string_view etag);

}  // namespace meshfront
