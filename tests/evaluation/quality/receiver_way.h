// Receiver-driven, as the viewer does it without a window: one request under way, a fresh ranking
// after each answer, batches of adaptiveBatch(), descendants with the first request
// (first_request.h), and the rim ranked where the viewer ranks it (shared/scene/seen_rim.h). Beyond
// what the viewer does, the order may be any.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "tests/evaluation/quality/counted_service.h"
#include "tests/evaluation/quality/receiver_order.h"
#include "tests/evaluation/quality/way.h"

namespace meshfront::evaluation {

// Where a receiver stops.
enum class ReceiverGoal {
  seen,      // what covers a pixel is split
  touching,  // and what has an edge to a vertex that does
  all
};

struct ReceiverWayOptions {
  uint32_t batch = 0;   // records a request; 0: adaptiveBatch()
  uint32_t window = 1;  // requests under way
  // Counts octets; null: every record counts as one byte, and the base as 1, for experiments that
  // count records alone, each asked for by itself.
  CountedService* service = nullptr;
  // By record: 0 = a leaf as far as this way goes. Empty: all are there.
  std::span<const uint8_t> allowed{};
  ReceiverGoal goal = ReceiverGoal::all;
  bool rim = true;  // ranked with what is seen, where the order has it so
};

class ReceiverWay final : public Way {
 public:
  [[nodiscard]] static Result<std::unique_ptr<ReceiverWay>> create(
      const PackRecords& pack, const ReceiverOrder& order, Easel& easel, const EvaluationView& view,
      const ReceiverWayOptions& options);

  [[nodiscard]] Result<bool> advance(uint64_t untilBytes) override;
  // Goes on where it had stopped.
  void goOn(ReceiverGoal goal) {
    goal_ = goal;
    started_ = false;
  }

 private:
  struct Flight {
    std::vector<RecordIndex> records;  // parents before their children
    ExchangeBytes bytes;
  };
  ReceiverWay(RefinedPack refined, const ReceiverOrder& order, Easel& easel,
              const EvaluationView& view, const ReceiverWayOptions& options);
  Result<void> rank();
  [[nodiscard]] std::vector<uint32_t> pixelsWithRim(std::span<const uint32_t> pixels) const;
  Result<void> send(std::span<const Candidate> chosen);
  [[nodiscard]] std::vector<Candidate> restCandidates(std::span<const uint32_t> pixels) const;
  void addDescendants(Flight& flight, unsigned significance) const;
  [[nodiscard]] bool isAllowed(NodeIndex node) const;

  const ReceiverOrder order_;
  const ReceiverWayOptions options_;
  std::deque<Flight> flights_;
  std::vector<uint8_t> busy_;  // by node
  ReceiverGoal goal_;
  bool started_ = false;
};

}  // namespace meshfront::evaluation
