// The open connections of a server: how many there are, from where, and for how long each has been
// in its present phase. Cuts those that take too long.
//
// The HTTP library closes connections that are silent. It does not see a client that sends an octet
// now and then and so never ends its request. Here every connection has a phase and the time at
// which it began; a thread looks at all of them some times a second, answers 408 to those that have
// been sending for too long, and shuts their sockets down, whereupon the library closes them.
//
//   idle --first octet--> line --its end--> header --end of the fields--> content --its end-->
//   answer --sent--> idle
//
// The library tells of a request only when its first line is whole. That a line has begun is seen
// from the number of octets that the kernel has received on a connection that counts as idle.
//
// Locking: a phase is one atomic word, changed by the thread that serves the connection and by the
// watching one; whoever changes it first decides, so that a request is either served or cut.
// Connections lie in shards, each with a lock that is taken to open, to close and to look through;
// a socket is not closed before close() has returned, so the thread meets none that is another's.
#pragma once

#include <sys/socket.h>

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <mutex>
#include <string>
#include <thread>
#include <unordered_map>

#include "shared/http/server_limits.h"

namespace meshfront {

class ConnectionWatch {
 public:
  enum class Phase : uint8_t { idle, line, header, content, answer, cut };
  enum class Admission : uint8_t { granted, tooMany, tooManyFromAddress };

  class Connection {
   public:
    // Called by the thread that serves the connection. False: it was cut meanwhile, so nothing may
    // be sent. `header` counts from where `line` began.
    [[nodiscard]] bool enter(Phase phase);
    [[nodiscard]] Admission admission() const { return admission_; }
    // Without port: "192.0.2.1", "2001:db8::1"; "-" where there is none.
    [[nodiscard]] std::string address() const;

   private:
    friend class ConnectionWatch;
    int socket_ = -1;
    sockaddr_storage peer_{};
    Admission admission_ = Admission::granted;
    int64_t opened_ = 0;     // ms
    uint64_t requests_ = 0;  // ended ones; tells one idle phase from the next
    std::atomic<uint64_t> state_{0};
    // Of the watching thread: what it saw in the idle phase `sweptState_`.
    uint64_t sweptState_ = 0;
    uint64_t sweptOctets_ = 0;
    std::list<Connection>::iterator self_;
  };

  // `onCut` is called from the watching thread, with the phase that took too long (idle: a refused
  // connection that never asked). It must not call the watch. Connections of an address
  // beyond its limit and refusedAtMost() are cut when they are opened.
  using OnCut = std::function<void(const Connection&, Phase)>;
  ConnectionWatch(const ServerLimits& limits, OnCut onCut);
  ~ConnectionWatch();
  ConnectionWatch(const ConnectionWatch&) = delete;
  ConnectionWatch& operator=(const ConnectionWatch&) = delete;

  // The connection belongs to the watch until close(). `peer` may be null.
  [[nodiscard]] Connection* open(int socket, const sockaddr* peer);
  void close(Connection* connection);  // before the socket is closed
  [[nodiscard]] size_t maxConnections() const { return maxConnections_; }

 private:
  static constexpr size_t kShards = 16;
  struct Shard {
    std::mutex mutex;
    std::list<Connection> connections;
  };
  // An IPv4 address, or the first half of an IPv6 one.
  struct Origin {
    uint64_t prefix = 0;
    bool sixth = false;
    bool operator==(const Origin&) const = default;
  };
  struct OriginHash {
    size_t operator()(const Origin& origin) const {
      return std::hash<uint64_t>{}(origin.prefix * 2 + (origin.sixth ? 1 : 0));
    }
  };
  [[nodiscard]] static Origin originOf(const sockaddr_storage& peer);
  [[nodiscard]] Shard& shardOf(int socket) {
    return shards_[static_cast<unsigned>(socket) % kShards];
  }
  void watch();
  void look(Connection& connection, int64_t now);
  [[nodiscard]] int64_t allowed(Phase phase) const;

  const size_t maxConnections_;
  const size_t maxPerAddress_;
  const int64_t headerTime_;  // ms, as those that follow
  const int64_t contentTime_;
  const int64_t answerTime_;
  const OnCut onCut_;

  std::atomic<size_t> count_{0};
  std::mutex originsMutex_;
  std::unordered_map<Origin, size_t, OriginHash> origins_;
  std::array<Shard, kShards> shards_;

  std::mutex endMutex_;
  std::condition_variable ending_;
  bool ended_ = false;
  std::thread thread_;
};

}  // namespace meshfront
