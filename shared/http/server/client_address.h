// Where a connection comes from.
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include <cstdint>
#include <functional>
#include <string>

namespace meshfront {

// What counts as one client: an IPv4 address, or the first half of an IPv6 one.
struct ClientOrigin {
  uint64_t prefix = 0;
  bool sixth = false;
  bool operator==(const ClientOrigin&) const = default;
};
struct ClientOriginHash {
  size_t operator()(const ClientOrigin& origin) const {
    return std::hash<uint64_t>{}(origin.prefix * 2 + (origin.sixth ? 1 : 0));
  }
};

class ClientAddress {
 public:
  ClientAddress() = default;
  explicit ClientAddress(const sockaddr_storage& peer);

  [[nodiscard]] ClientOrigin origin() const;  // IPv4 within IPv6 counts as IPv4
  // Without port: "192.0.2.1", "2001:db8::1"; "-" where there is none.
  [[nodiscard]] std::string text() const;

 private:
  sa_family_t family_ = AF_UNSPEC;
  in6_addr bytes_{};  // IPv4: the first 4
};

}  // namespace meshfront
