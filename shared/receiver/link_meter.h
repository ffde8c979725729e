// What the way to the service carries, measured on the answers as they come: the shortest round
// trip and the greatest throughput of the last seconds, and from both how many requests keep it
// busy. After BBR (Cardwell et al. 2016), for requests in the place of packets.
//
// Belongs to the receiver's thread. Times are those that the transport tells; an answer without
// them changes nothing.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>

#include "shared/receiver/transport.h"

namespace meshfront {

class LinkMeter {
 public:
  using Clock = FetchTiming::Clock;
  static constexpr std::chrono::seconds kMemory{10};  // what is older tells nothing of now
  static constexpr uint32_t kWidestWindow = 16;       // requests

  void observe(const FetchResponse& response);

  // From a request's last octet up to the answer's first one, the service's work included.
  [[nodiscard]] std::optional<std::chrono::nanoseconds> roundTrip() const;
  [[nodiscard]] std::optional<double> bytesPerSecond() const;  // down, headers included
  // What is on its way when the link is busy: throughput times round trip, octets; 0 before the
  // first answer. Too small while too little is asked for, and growing as more is.
  [[nodiscard]] double productBytes() const;
  // Requests under way that keep the link busy if their answers are of `answerBytes`:
  // 1..kWidestWindow; nullopt before the first answer.
  [[nodiscard]] std::optional<uint32_t> window(double answerBytes) const;

 private:
  struct Sample {
    Clock::time_point done;
    uint64_t bytes = 0;
    std::chrono::nanoseconds roundTrip{0};
    double bytesPerSecond = 0;
  };
  std::deque<Sample> samples_;  // as they were observed
};

}  // namespace meshfront
