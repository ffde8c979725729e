// What the HTTP server counts, apart from what is asked for. The names are those of /metrics, where
// each is explained.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "shared/http/metrics.h"

namespace meshfront {

// Open connections, requests between their first line and their end, and the octets that these
// hold: contents received and answers that are not sent yet.
class InFlight {
 public:
  explicit InFlight(size_t maxBytes) : maxBytes_(maxBytes) {}
  // False, without taking any, where they do not fit.
  [[nodiscard]] bool take(size_t bytes) {
    if (bytes_.fetch_add(bytes, std::memory_order_relaxed) + bytes <= maxBytes_) return true;
    giveBack(bytes);
    return false;
  }
  void giveBack(size_t bytes) { bytes_.fetch_sub(bytes, std::memory_order_relaxed); }
  [[nodiscard]] size_t bytes() const { return bytes_.load(std::memory_order_relaxed); }

  std::atomic<size_t> connections{0};
  alignas(64) std::atomic<size_t> requests{0};

 private:
  const size_t maxBytes_;
  alignas(64) std::atomic<size_t> bytes_{0};
};

// What a connection is doing.
//
//   idle --first octet--> line --its end--> header --end of the fields--> content --its end-->
//   answer --sent--> idle
enum class ConnectionPhase : uint8_t { idle, line, header, content, answer };

// Why a request was refused before anybody looked at what it asks for.
enum class Refusal : uint8_t { none, header, address, connections, memory, target, malformed };

struct FrontMetrics {
  // Shared with what /metrics calls, which may outlive the server.
  FrontMetrics(Metrics& metrics, const std::shared_ptr<const InFlight>& inFlight);

  [[nodiscard]] Counter& refused(Refusal reason) {
    return *refused_[static_cast<size_t>(reason) - 1];
  }
  [[nodiscard]] Counter& cut(ConnectionPhase phase) { return *cut_[static_cast<size_t>(phase)]; }

  Histogram& requestSeconds;
  Counter& connections;
  Counter& unfinished;  // answers that were not sent to their end

 private:
  std::array<Counter*, 6> refused_{};
  std::array<Counter*, 5> cut_{};
};

}  // namespace meshfront
