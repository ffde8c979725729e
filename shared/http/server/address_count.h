// How many connections are open, in all and from each client. Called from any thread, when a
// connection is opened and when it is closed.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <unordered_map>

#include "shared/http/server/client_address.h"
#include "shared/http/server/server_limits.h"

namespace meshfront {

// One that is not granted is kept until it has been refused, unless too many wait for that already.
enum class Admission : uint8_t { granted, tooMany, tooManyFromAddress, closedAtOnce };

class AddressCount {
 public:
  explicit AddressCount(const ServerLimits& limits)
      : maxConnections_(limits.maxConnections), maxPerAddress_(limits.maxConnectionsPerAddress) {}

  // Counted until close() with the same origin, whatever the outcome.
  [[nodiscard]] Admission open(const ClientOrigin& origin);
  void close(const ClientOrigin& origin);

  // No more are to be accepted.
  [[nodiscard]] bool full() const {
    return open_.load(std::memory_order_relaxed) >=
           maxConnections_ + refusedAtMost(maxConnections_);
  }

 private:
  const size_t maxConnections_;
  const size_t maxPerAddress_;
  std::atomic<size_t> open_{0};
  std::mutex mutex_;
  std::unordered_map<ClientOrigin, size_t, ClientOriginHash> byOrigin_;
};

}  // namespace meshfront
