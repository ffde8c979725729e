#include "shared/http/connection_watch.h"

#include <arpa/inet.h>
#include <linux/tcp.h>  // knows more of tcp_info than <netinet/tcp.h>
#include <netinet/in.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstring>

#include "shared/http/problem.h"

namespace meshfront {
namespace {

using Phase = ConnectionWatch::Phase;

constexpr unsigned kPhaseBits = 3;

// A few milliseconds coarse, and cheap: it is read several times a request.
int64_t coarseMilliseconds() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC_COARSE, &time);
  return int64_t{time.tv_sec} * 1000 + time.tv_nsec / 1'000'000;
}

uint64_t stateOf(Phase phase, uint64_t value) {
  return value << kPhaseBits | static_cast<uint64_t>(phase);
}
Phase phaseOf(uint64_t state) {
  return static_cast<Phase>(state & ((1U << kPhaseBits) - 1));
}
int64_t sinceOf(uint64_t state) {
  return static_cast<int64_t>(state >> kPhaseBits);
}

int64_t inMilliseconds(double seconds) {
  return static_cast<int64_t>(seconds * 1000);
}

uint64_t octetsReceived(int socket) {
  tcp_info info{};
  socklen_t length = sizeof info;
  // Older kernels fill less; what they leave out stays 0.
  if (::getsockopt(socket, IPPROTO_TCP, TCP_INFO, &info, &length) != 0) return 0;
  return info.tcpi_bytes_received;
}

void sayTooSlow(int socket) {
  static const std::string kText = [] {
    const HttpResponse response =
        problem(408, "the request took too long to arrive; send it again");
    const auto content = response.content.bytes();
    std::string text = "HTTP/1.1 408 Request Timeout\r\nConnection: close\r\n";
    for (const auto& [name, value] : response.headers)
      text.append(name).append(": ").append(value).append("\r\n");
    text += "Access-Control-Allow-Origin: *\r\nContent-Length: " + std::to_string(content.size());
    return text.append("\r\n\r\n").append(content.begin(), content.end());
  }();
  // Nothing has been sent for this request, and nothing will be: its phase says that it is cut.
  (void)::send(socket, kText.data(), kText.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
}

}  // namespace

bool ConnectionWatch::Connection::enter(Phase phase) {
  uint64_t old = state_.load(std::memory_order_relaxed);
  uint64_t next = phase == Phase::idle
                      ? stateOf(phase, ++requests_)
                      : stateOf(phase, static_cast<uint64_t>(coarseMilliseconds()));
  do {
    if (phaseOf(old) == Phase::cut) return false;
    if (phase == Phase::header && phaseOf(old) == Phase::line)
      next = stateOf(phase, old >> kPhaseBits);
  } while (!state_.compare_exchange_weak(old, next, std::memory_order_acq_rel));
  return true;
}

std::string ConnectionWatch::Connection::address() const {
  std::array<char, INET6_ADDRSTRLEN> text{};
  const void* bytes = nullptr;
  if (peer_.ss_family == AF_INET)
    bytes = &reinterpret_cast<const sockaddr_in&>(peer_).sin_addr;
  else if (peer_.ss_family == AF_INET6)
    bytes = &reinterpret_cast<const sockaddr_in6&>(peer_).sin6_addr;
  if (bytes == nullptr || ::inet_ntop(peer_.ss_family, bytes, text.data(),
                                      static_cast<socklen_t>(text.size())) == nullptr)
    return "-";
  return text.data();
}

ConnectionWatch::ConnectionWatch(const ServerLimits& limits, OnCut onCut)
    : maxConnections_(limits.maxConnections),
      maxPerAddress_(limits.maxConnectionsPerAddress),
      headerTime_(inMilliseconds(limits.headerTimeout)),
      contentTime_(inMilliseconds(limits.contentTimeout)),
      answerTime_(inMilliseconds(limits.answerTimeout)),
      onCut_(std::move(onCut)),
      thread_([this] { watch(); }) {}

ConnectionWatch::~ConnectionWatch() {
  {
    const std::scoped_lock lock(endMutex_);
    ended_ = true;
  }
  ending_.notify_all();
  thread_.join();
}

ConnectionWatch::Origin ConnectionWatch::originOf(const sockaddr_storage& peer) {
  Origin origin;
  if (peer.ss_family == AF_INET) {
    origin.prefix = reinterpret_cast<const sockaddr_in&>(peer).sin_addr.s_addr;
  } else if (peer.ss_family == AF_INET6) {
    const in6_addr& address = reinterpret_cast<const sockaddr_in6&>(peer).sin6_addr;
    if (IN6_IS_ADDR_V4MAPPED(&address)) {
      uint32_t fourth = 0;
      std::memcpy(&fourth, &address.s6_addr[12], sizeof fourth);
      origin.prefix = fourth;
    } else {
      std::memcpy(&origin.prefix, &address.s6_addr[0], sizeof origin.prefix);
      origin.sixth = true;
    }
  }
  return origin;
}

ConnectionWatch::Connection* ConnectionWatch::open(int socket, const sockaddr* peer) {
  sockaddr_storage address{};
  if (peer != nullptr)
    std::memcpy(&address, peer,
                peer->sa_family == AF_INET6 ? sizeof(sockaddr_in6) : sizeof(sockaddr_in));
  const bool tooMany = count_.fetch_add(1, std::memory_order_relaxed) >= maxConnections_;
  size_t fromAddress = 0;
  {
    const std::scoped_lock lock(originsMutex_);
    fromAddress = ++origins_[originOf(address)];
  }
  Shard& shard = shardOf(socket);
  const std::scoped_lock lock(shard.mutex);
  Connection& connection = shard.connections.emplace_back();
  connection.self_ = std::prev(shard.connections.end());
  connection.socket_ = socket;
  connection.peer_ = address;
  connection.opened_ = coarseMilliseconds();
  if (fromAddress > maxPerAddress_)
    connection.admission_ = Admission::tooManyFromAddress;
  else if (tooMany)
    connection.admission_ = Admission::tooMany;
  if (fromAddress > maxPerAddress_ + refusedAtMost(maxPerAddress_)) {
    connection.state_ = stateOf(Phase::cut, 0);
    ::shutdown(socket, SHUT_RDWR);
  }
  return &connection;
}

void ConnectionWatch::close(Connection* connection) {
  {
    const std::scoped_lock lock(originsMutex_);
    const auto it = origins_.find(originOf(connection->peer_));
    if (--it->second == 0) origins_.erase(it);
  }
  count_.fetch_sub(1, std::memory_order_relaxed);
  Shard& shard = shardOf(connection->socket_);
  const std::scoped_lock lock(shard.mutex);
  shard.connections.erase(connection->self_);
}

int64_t ConnectionWatch::allowed(Phase phase) const {
  if (phase == Phase::line || phase == Phase::header) return headerTime_;
  return phase == Phase::content ? contentTime_ : answerTime_;
}

void ConnectionWatch::watch() {
  const std::chrono::milliseconds pause(
      std::clamp<int64_t>(std::min({headerTime_, contentTime_, answerTime_}) / 8, 20, 1000));
  std::unique_lock lock(endMutex_);
  while (!ending_.wait_for(lock, pause, [this] { return ended_; })) {
    lock.unlock();
    for (Shard& shard : shards_) {
      const std::scoped_lock shardLock(shard.mutex);
      const int64_t now = coarseMilliseconds();
      for (Connection& connection : shard.connections) look(connection, now);
    }
    lock.lock();
  }
}

void ConnectionWatch::look(Connection& connection, int64_t now) {
  uint64_t state = connection.state_.load(std::memory_order_acquire);
  const Phase phase = phaseOf(state);
  if (phase == Phase::cut) return;
  if (phase == Phase::idle) {
    const bool refusedInVain =
        connection.admission_ != Admission::granted && now - connection.opened_ > headerTime_;
    if (!refusedInVain) {
      const uint64_t octets = octetsReceived(connection.socket_);
      if (state != connection.sweptState_) {
        connection.sweptState_ = state;
        connection.sweptOctets_ = octets;
      } else if (octets != connection.sweptOctets_) {
        connection.state_.compare_exchange_strong(
            state, stateOf(Phase::line, static_cast<uint64_t>(now)), std::memory_order_acq_rel);
      }
      return;
    }
  } else if (now - sinceOf(state) <= allowed(phase)) {
    return;
  }
  if (!connection.state_.compare_exchange_strong(state, stateOf(Phase::cut, 0),
                                                 std::memory_order_acq_rel))
    return;                   // it has just gone on
  onCut_(connection, phase);  // first: who sees the end may ask what was counted
  if (phase != Phase::idle && phase != Phase::answer) sayTooSlow(connection.socket_);
  ::shutdown(connection.socket_, SHUT_RDWR);
}

}  // namespace meshfront
