// Sender-driven: the server keeps what the client has and sends what its view lacks, over one
// connection (tests/evaluation/sender_driven).
#pragma once

#include <memory>

#include "tests/evaluation/quality/way.h"
#include "tests/evaluation/sender_driven/sender_session.h"

namespace meshfront::evaluation {

class SenderWay final : public Way {
 public:
  // `model`: of the same pack; outlives the way. `goesOn`: when the view has all it asks for, the
  // rest.
  [[nodiscard]] static Result<std::unique_ptr<SenderWay>> create(
      const PackRecords& pack, const SenderModel& model, const SenderOptions& options, Easel& easel,
      const EvaluationView& view, bool goesOn);
  [[nodiscard]] Result<bool> advance(uint64_t untilBytes) override;

 private:
  SenderWay(RefinedPack refined, const SenderModel& model, const SenderOptions& options,
            Easel& easel, const EvaluationView& view)
      : Way(std::move(refined), easel, view), session_(model, options) {}

  SenderSession session_;
};

}  // namespace meshfront::evaluation
