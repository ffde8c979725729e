// Asks for the records of exactly the nodes that the view wants, batch by batch.
//   rank     fresh pixel counts -> queue_ of nodes, best first
//   request  queue_ -> flights_, one request each, their nodes busy
//   apply    the first flight's answer -> splits
// Flights are applied in the order of the requests although answers may overtake each other: the
// mesh after n answers, and so every later request, is then the same for everybody who looks at the
// same view.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shared/receiver/record_source.h"

namespace meshfront {

class ExactSource final : public RecordSource {
 public:
  explicit ExactSource(SourceSurroundings surroundings);
  ~ExactSource() override;

  void take(Arrival arrival) override;
  void rank(std::span<const uint32_t> pixels) override;
  void request() override;
  bool apply(size_t maxSplits) override;
  void giveUp() override;
  [[nodiscard]] bool canApply() const override;
  [[nodiscard]] bool hasRoom() const override;
  [[nodiscard]] bool wantsRanking() const override;
  [[nodiscard]] bool idle() const override { return flights_.empty(); }
  [[nodiscard]] bool limitReached() const override { return batchSize() == 0; }
  [[nodiscard]] bool exhausted() const override { return restExhausted_; }
  [[nodiscard]] size_t requestsUnderWay() const override { return flights_.size(); }

 private:
  struct Flight {
    uint64_t sequence = 0;
    FetchId id = 0;
    std::shared_ptr<const RecordRequest> request;
    std::vector<NodeIndex> nodes;           // of the request, in its order
    std::optional<RecordsArrival> arrival;  // else under way
    size_t applied = 0;                     // entries of the arrival
  };

  void send(Flight& flight, bool bypassCaches);
  void refillFromRest();
  [[nodiscard]] uint64_t pendingRecords() const;
  [[nodiscard]] size_t batchSize() const;

  void finishFirstFlight();
  void refuseFirstFlight();                            // a status other than 200
  void rejectFirstFlight(const std::string& problem);  // a malformed answer
  void dropFirstFlight();
  void cancelAll();
  void markUnapplied();

  [[nodiscard]] bool isBusy(NodeIndex node) const;
  void setBusy(NodeIndex node, bool busy);

  const SourceSurroundings to_;
  SelectivelyRefinedMesh& mesh_;
  const std::shared_ptr<const CodeTables> tables_;
  std::deque<std::unique_ptr<Flight>> flights_;  // in the order of the requests
  uint64_t lastSequence_ = 0;
  std::vector<uint8_t> busy_;     // by node: asked for, not yet applied
  std::vector<NodeIndex> queue_;  // ranked, best first, from queueNext_ on
  size_t queueNext_ = 0;
  std::optional<uint8_t>
      queueExpansion_;          // the queue holds the rest, to be asked for up to this level
  bool restExhausted_ = false;  // nothing left to split, whatever the base promised
  bool expansionRefused_ = false;
  size_t batchLimit_ = SIZE_MAX;  // set where a server refuses larger requests
  unsigned malformedInRow_ = 0;
  RequestBudget budget_;
};

}  // namespace meshfront
