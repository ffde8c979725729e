// Error answers: application/problem+json (RFC 9457). They carry what the client did, never where
// the server keeps things.
#pragma once

#include <string_view>

#include "shared/http/message.h"
#include "shared/result.h"

namespace meshfront {

// `detail` is for people and may quote nothing but what the client sent or the interface defines.
[[nodiscard]] HttpResponse problem(unsigned status, std::string_view detail);
// The status that an error of a store means, and its problem. Details of damage and of unavailable
// sources are kept from the client.
[[nodiscard]] HttpResponse problemFor(const Error& error);
[[nodiscard]] std::string_view reasonPhrase(unsigned status);

}  // namespace meshfront
