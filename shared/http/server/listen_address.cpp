#include "shared/http/server/listen_address.h"

#include <netdb.h>

#include <charconv>
#include <cstring>
#include <memory>

namespace meshfront {

Result<ListenAddress> resolveListenAddress(std::string_view text) {
  const auto complaint = [&] {
    return fail("listen address \"" + std::string(text) +
                "\": must be HOST:PORT or [IPV6]:PORT, for example 127.0.0.1:8080");
  };
  const size_t colon = text.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return complaint();
  const std::string_view port = text.substr(colon + 1);
  ListenAddress address;
  address.host = text.substr(0, colon);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  if (error != std::errc() || port.empty() || end != port.data() + port.size()) return complaint();

  std::string node = address.host;
  if (node.front() == '[' && node.back() == ']') {
    node = node.substr(1, node.size() - 2);
  } else if (node.find(':') != std::string::npos) {
    return complaint();
  }
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const std::string service(port);
  if (const int status = getaddrinfo(node.c_str(), service.c_str(), &hints, &list); status != 0)
    return fail("listen address \"" + std::string(text) + "\": " + gai_strerror(status));
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner(list, &freeaddrinfo);
  std::memcpy(&address.socketAddress, list->ai_addr, list->ai_addrlen);
  return address;
}

}  // namespace meshfront
