// What a server says of a refused request (RFC 9457), made fit for a message.
#pragma once

#include <span>
#include <string>

#include "shared/receiver/transport.h"

namespace meshfront {

// "HTTP 400: not canonical": the problem's title and detail where there are any. Untrusted: cut to
// 200 printable characters.
[[nodiscard]] std::string describeRefusal(const FetchResponse& response);

}  // namespace meshfront
