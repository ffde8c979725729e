// Where a program listens: HOST:PORT, [IPV6]:PORT; port 0 lets the system choose.
#pragma once

#include <sys/socket.h>

#include <cstdint>
#include <string>
#include <string_view>

#include "shared/result.h"

namespace meshfront {

struct ListenAddress {
  std::string host;  // as given, brackets included
  uint16_t port = 0;
  sockaddr_storage socketAddress{};
};

// Names are resolved here, so this may wait for a name server.
[[nodiscard]] Result<ListenAddress> resolveListenAddress(std::string_view text);

}  // namespace meshfront
