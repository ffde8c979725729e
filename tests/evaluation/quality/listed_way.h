// Splits that come in a list's order, whatever the view: view-independent, or random. The IDs are
// implied by the order, so that records are all that comes: one answer after the base mesh, as
// long as it lasts, applied as it comes in.
#pragma once

#include <memory>
#include <vector>

#include "tests/evaluation/quality/counted_service.h"
#include "tests/evaluation/quality/way.h"

namespace meshfront::evaluation {

class ListedWay final : public Way {
 public:
  // `order`: each record behind its parent's. `service` as ReceiverWayOptions has it.
  [[nodiscard]] static Result<std::unique_ptr<ListedWay>> create(const PackRecords& pack,
                                                                 std::vector<RecordIndex> order,
                                                                 Easel& easel,
                                                                 const EvaluationView& view,
                                                                 CountedService* service);
  [[nodiscard]] Result<bool> advance(uint64_t untilBytes) override;

 private:
  ListedWay(RefinedPack refined, std::vector<RecordIndex> order, Easel& easel,
            const EvaluationView& view)
      : Way(std::move(refined), easel, view), order_(std::move(order)) {}

  const std::vector<RecordIndex> order_;
  size_t next_ = 0;
  bool countsBytes_ = false;
  uint64_t setupBytes_ = 1;
  uint64_t bits_ = 0;
};

// A random order in which every record comes behind its parent's: of those that can be applied, any
// is as likely as any other.
[[nodiscard]] std::vector<RecordIndex> randomOrder(std::span<const PackRecord> records,
                                                   uint32_t seed);

}  // namespace meshfront::evaluation
