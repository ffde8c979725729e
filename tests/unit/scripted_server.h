// An HTTP/1.1 server on loopback whose answers a test writes byte by byte.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace meshfront {

class ScriptedServer {
 public:
  // Gets the request as it came, all of its octets; returns the octets to answer with, or nullopt
  // to close the connection. Called from a thread for each connection.
  using Script = std::function<std::optional<std::string>(const std::string& request)>;

  explicit ScriptedServer(Script script) : script_(std::move(script)) {
    listener_ = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ::bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address);
    ::listen(listener_, 64);
    socklen_t length = sizeof address;
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &length);
    port_ = ntohs(address.sin_port);
    acceptor_ = std::thread([this] { acceptAll(); });
  }
  ~ScriptedServer() {
    ::shutdown(listener_, SHUT_RDWR);
    acceptor_.join();
    ::close(listener_);
    {
      const std::lock_guard lock(mutex_);
      for (const int connection : connections_) ::shutdown(connection, SHUT_RDWR);
    }
    for (std::thread& server : servers_) server.join();
    for (const int connection : connections_) ::close(connection);
  }
  ScriptedServer(const ScriptedServer&) = delete;
  ScriptedServer& operator=(const ScriptedServer&) = delete;

  [[nodiscard]] std::string origin() const { return "http://127.0.0.1:" + std::to_string(port_); }
  [[nodiscard]] std::vector<std::string> requests() const {
    const std::lock_guard lock(mutex_);
    return requests_;
  }
  [[nodiscard]] uint64_t bytesIn() const { return bytesIn_; }
  [[nodiscard]] uint64_t bytesOut() const { return bytesOut_; }
  [[nodiscard]] size_t connectionCount() const {
    const std::lock_guard lock(mutex_);
    return connections_.size();
  }

  static std::string ok(const std::string& body, const std::string& headers = "") {
    return "HTTP/1.1 200 OK\r\n" + headers + "Content-Length: " + std::to_string(body.size()) +
           "\r\n\r\n" + body;
  }
  static std::string refusal(const std::string& status, const std::string& headers = "") {
    return "HTTP/1.1 " + status + "\r\n" + headers + "Content-Length: 0\r\n\r\n";
  }

 private:
  void acceptAll() {
    while (true) {
      const int connection = ::accept(listener_, nullptr, nullptr);
      if (connection < 0) return;
      const std::lock_guard lock(mutex_);
      connections_.push_back(connection);
      servers_.emplace_back([this, connection] { serve(connection); });
    }
  }
  void serve(int connection) {
    std::string buffer;
    while (std::optional<std::string> request = receive(connection, buffer)) {
      {
        const std::lock_guard lock(mutex_);
        requests_.push_back(*request);
      }
      const std::optional<std::string> answer = script_(*request);
      if (!answer) break;
      // Before the octets: who got the answer may ask at once.
      bytesOut_ += answer->size();
      if (::send(connection, answer->data(), answer->size(), MSG_NOSIGNAL) < 0) break;
    }
    ::shutdown(connection, SHUT_RDWR);
  }
  std::optional<std::string> receive(int connection, std::string& buffer) {
    while (true) {
      const size_t end = buffer.find("\r\n\r\n");
      if (end != std::string::npos) {
        size_t length = end + 4;
        const size_t field = buffer.find("Content-Length: ");
        if (field < end) length += std::stoul(buffer.substr(field + 16));
        if (buffer.size() >= length) {
          std::string request = buffer.substr(0, length);
          buffer.erase(0, length);
          bytesIn_ += length;
          return request;
        }
      }
      char block[16384];
      const ssize_t got = ::recv(connection, block, sizeof block, 0);
      if (got <= 0) return std::nullopt;
      buffer.append(block, static_cast<size_t>(got));
    }
  }

  Script script_;
  int listener_ = -1;
  unsigned port_ = 0;
  std::thread acceptor_;
  std::atomic<uint64_t> bytesIn_{0};
  std::atomic<uint64_t> bytesOut_{0};
  mutable std::mutex mutex_;
  std::vector<std::string> requests_;
  std::vector<int> connections_;
  std::vector<std::thread> servers_;  // touched by the acceptor, then by the destructor
};

}  // namespace meshfront
