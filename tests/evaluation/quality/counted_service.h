// The record service of one pack in this process, and what its answers would cost over HTTP: every
// octet of status line, fields and content as the server writes them, as the viewer counts them.
#pragma once

#include <cstdint>
#include <memory>

#include "shared/http/metrics.h"
#include "shared/http/record_service.h"
#include "shared/receiver/record_request.h"
#include "shared/receiver/transport.h"
#include "shared/result.h"
#include "tests/evaluation/view_independent/pack_records.h"

namespace meshfront::evaluation {

// Octets of one exchange.
struct ExchangeBytes {
  uint64_t up = 0;
  uint64_t down = 0;
};

class CountedService {
 public:
  // `pack` as PackRecords holds it.
  explicit CountedService(std::shared_ptr<const Pack> pack);
  CountedService(const CountedService&) = delete;
  CountedService& operator=(const CountedService&) = delete;
  ~CountedService();

  // Errors: an answer other than 200.
  [[nodiscard]] Result<ExchangeBytes> metadata();
  [[nodiscard]] Result<ExchangeBytes> base();
  [[nodiscard]] Result<ExchangeBytes> records(const RecordRequest& request);
  // A whole answer of so much content, with the fields of an answer of records.
  [[nodiscard]] uint64_t fieldBytes() const { return fieldBytes_; }

 private:
  class OneMesh;
  [[nodiscard]] Result<ExchangeBytes> exchange(const FetchRequest& request);

  std::unique_ptr<OneMesh> catalogue_;
  Metrics metrics_;
  RecordService service_;
  MeshUrl url_;
  std::string revision_;
  uint64_t fieldBytes_ = 0;
};

}  // namespace meshfront::evaluation
