// Receiver-driven, as the viewer does it without a window: two requests under way, a fresh ranking
// after each answer, batches of adaptiveBatch(). Beyond what the viewer does, the order may be any.
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
  uint32_t window = 2;  // requests under way
  // Counts octets; null: every record counts as one byte, and the base as 1, for experiments that
  // count records alone.
  CountedService* service = nullptr;
  // By record: 0 = a leaf as far as this way goes. Empty: all are there.
  std::span<const uint8_t> allowed{};
  ReceiverGoal goal = ReceiverGoal::all;
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
    std::vector<NodeIndex> nodes;  // in preorder of their IDs
    ExchangeBytes bytes;
  };
  ReceiverWay(RefinedPack refined, const ReceiverOrder& order, Easel& easel,
              const EvaluationView& view, const ReceiverWayOptions& options);
  Result<void> rank();
  Result<void> send(std::span<const Candidate> chosen);
  [[nodiscard]] std::vector<Candidate> restCandidates(std::span<const uint32_t> pixels) const;
  [[nodiscard]] bool isAllowed(NodeIndex node) const;

  const ReceiverOrder order_;
  const ReceiverWayOptions options_;
  std::deque<Flight> flights_;
  std::vector<uint8_t> busy_;  // by node
  ReceiverGoal goal_;
  bool started_ = false;
};

}  // namespace meshfront::evaluation
