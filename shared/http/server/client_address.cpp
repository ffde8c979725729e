#include "shared/http/server/client_address.h"

#include <arpa/inet.h>

#include <array>
#include <cstring>

namespace meshfront {

ClientAddress::ClientAddress(const sockaddr_storage& peer) : family_(peer.ss_family) {
  if (family_ == AF_INET)
    std::memcpy(&bytes_, &reinterpret_cast<const sockaddr_in&>(peer).sin_addr, sizeof(in_addr));
  else if (family_ == AF_INET6)
    bytes_ = reinterpret_cast<const sockaddr_in6&>(peer).sin6_addr;
}

ClientOrigin ClientAddress::origin() const {
  const bool mapped = family_ == AF_INET6 && IN6_IS_ADDR_V4MAPPED(&bytes_);
  ClientOrigin origin;
  if (family_ == AF_INET6 && !mapped) {
    std::memcpy(&origin.prefix, &bytes_, sizeof origin.prefix);
    origin.sixth = true;
  } else {
    std::memcpy(&origin.prefix, &bytes_.s6_addr[mapped ? 12 : 0], sizeof(in_addr));
  }
  return origin;
}

std::string ClientAddress::text() const {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if ((family_ != AF_INET && family_ != AF_INET6) ||
      ::inet_ntop(family_, &bytes_, text.data(), static_cast<socklen_t>(text.size())) == nullptr)
    return "-";
  return text.data();
}

}  // namespace meshfront
