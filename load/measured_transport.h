// A transport that counts what goes through another one: requests, bytes, errors by kind and how
// long answers took, from the receiver's call to the answer, waiting for a connection and retries
// included. Thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "load/duration_percentiles.h"
#include "shared/receiver/transport.h"

namespace meshfront {

struct TransportCounts {
  uint64_t requests = 0;       // answered, or given up by the transport
  uint64_t repeated = 0;       // attempts beyond the first of each
  uint64_t recordAnswers = 0;  // with records, or chunks
  uint64_t recordBytes = 0;    // their bodies, without headers
  Traffic traffic;
  std::map<std::string, uint64_t> errors;  // by kind: "no answer", "status 503"
  DurationPercentiles latency;
};

class MeasuredTransport final : public Transport {
 public:
  explicit MeasuredTransport(Transport& inner) : inner_(inner), state_(std::make_shared<State>()) {}

  [[nodiscard]] FetchId send(FetchRequest request, Completion completion) override;
  void cancel(FetchId id) override { inner_.cancel(id); }
  [[nodiscard]] TransportCounts counts() const;

 private:
  struct State {  // completions share it and may outlive this
    std::mutex mutex;
    TransportCounts counts;
  };
  Transport& inner_;
  std::shared_ptr<State> state_;
};

}  // namespace meshfront
