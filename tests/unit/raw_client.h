// A client that sends any octets, and takes responses apart no further than at their lengths.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <string>
#include <utility>

namespace meshfront {

class RawClient {
 public:
  explicit RawClient(uint16_t port, int receiveBuffer = 0)
      : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (receiveBuffer > 0)
      ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receiveBuffer, sizeof receiveBuffer);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  ~RawClient() { ::close(socket_); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  bool send(const std::string& text) {
    return ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(text.size());
  }
  void endSending() { ::shutdown(socket_, SHUT_WR); }
  // Sends octets of `text` one by one, over and over, until the other side has said something or
  // has closed the connection.
  void trickle(const std::string& text) {
    for (size_t i = 0;; ++i) {
      pollfd state{socket_, POLLIN, 0};
      if (::poll(&state, 1, 20) > 0) return;
      if (!send(text.substr(i % text.size(), 1))) return;
    }
  }
  // One response; what there is where the connection ends.
  std::string receive() {
    while (true) {
      const size_t end = buffer_.find("\r\n\r\n");
      if (end != std::string::npos) {
        const size_t field = buffer_.find("Content-Length: ");
        const size_t length = end + 4 + (field < end ? std::stoul(buffer_.substr(field + 16)) : 0);
        if (buffer_.size() >= length) {
          std::string response = buffer_.substr(0, length);
          buffer_.erase(0, length);
          return response;
        }
      }
      if (!receiveMore()) return std::exchange(buffer_, {});
    }
  }
  std::string receiveAll() {
    while (receiveMore()) {
    }
    return std::exchange(buffer_, {});
  }
  std::string ask(const std::string& target) {
    send("GET " + target + " HTTP/1.1\r\nHost: x\r\n\r\n");
    return receive();
  }

 private:
  bool receiveMore() {
    std::array<char, 16384> block{};
    const ssize_t got = ::recv(socket_, block.data(), block.size(), 0);
    if (got <= 0) return false;
    buffer_.append(block.data(), static_cast<size_t>(got));
    return true;
  }
  int socket_;
  std::string buffer_;
};

}  // namespace meshfront
