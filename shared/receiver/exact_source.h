// Asks for the records of exactly the nodes that the view wants, batch by batch.
//   rank     fresh pixel counts -> plan_ of nodes whose records are at hand
//                               -> queue_ of the others, best first
//   request  queue_ -> flights_, one request each, their nodes busy and pinned
//   apply    plan_, then the first flight's answer -> splits
// Flights are applied in the order of the requests although answers may overtake each other: the
// mesh after n answers, and so every later request, is then the same for everybody who looks at the
// same view. Between two calls the mesh's owner may collapse and split nodes as it likes: a record
// that arrives for a node that is not active is kept.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shared/receiver/local_records.h"
#include "shared/receiver/record_source.h"
#include "shared/receiver/split_plan.h"

namespace meshfront {

class ExactSource final : public RecordSource {
 public:
  explicit ExactSource(SourceSurroundings surroundings);
  ~ExactSource() override;

  void take(Arrival arrival) override;
  void rank(std::span<const uint32_t> pixels, const RankingBias& bias) override;
  void rankAhead(std::span<const uint32_t> pixels) override;
  void request() override;
  bool apply(size_t maxSplits) override;
  void giveUp() override;
  void forgot(std::span<const NodeId> nodes) override;
  [[nodiscard]] bool canApply() const override;
  [[nodiscard]] bool hasRoom() const override;
  [[nodiscard]] bool wantsRanking() const override;
  [[nodiscard]] bool idle() const override;
  [[nodiscard]] bool limitReached() const override { return batchSize() == 0; }
  [[nodiscard]] bool exhausted() const override { return restExhausted_; }
  [[nodiscard]] bool isFetching() const override;
  [[nodiscard]] uint32_t window() const override { return windowNow(to_); }
  [[nodiscard]] size_t requestsUnderWay() const override { return flights_.size(); }

 private:
  struct Flight {
    uint64_t sequence = 0;
    FetchId id = 0;
    std::shared_ptr<const RecordRequest> request;
    std::vector<NodeIndex> nodes;           // of the request, in its order
    uint64_t mostRecords = 0;               // that the answer is taken to hold
    bool ahead = false;                     // for a view that may come
    std::optional<RecordsArrival> arrival;  // else under way
    size_t applied = 0;                     // entries of the arrival
  };
  static constexpr size_t kCompletingBatch = 4'000;  // nothing is ranked any more: fewer, larger
  struct Wish {
    NodeIndex node = kNone;
    uint32_t pixels = 0;
  };

  void sendBatch(std::vector<Wish> chosen, bool ahead);
  void send(Flight& flight, bool bypassCaches);
  void requestAhead();
  [[nodiscard]] std::vector<Wish> takeBatch(std::vector<Wish>& from, size_t& next) const;
  // Of the first request it also takes nodes out of `chosen`: the next ranking wishes for them
  // again.
  [[nodiscard]] Expansion expansionFor(std::vector<Wish>& chosen) const;
  [[nodiscard]] bool tripWorthGuessing() const;
  [[nodiscard]] double firstRoom() const;
  [[nodiscard]] std::optional<uint8_t> significanceAtFirst(std::vector<Wish>& chosen) const;
  [[nodiscard]] uint64_t likelyRecords(const RecordRequest& request) const;
  [[nodiscard]] uint32_t levelsByNeed(const std::vector<Wish>& chosen) const;
  void refillFromRest();
  [[nodiscard]] uint64_t pendingRecords() const;
  [[nodiscard]] size_t batchSize() const;
  void planOrQueue(std::vector<Candidate>& candidates, size_t queued);
  void forgetQueue();

  bool applyPlan(size_t maxSplits);
  [[nodiscard]] bool planWaits() const { return !plan_.empty() && to_.allowance.left() > 0; }
  [[nodiscard]] bool applyEntry(Flight& flight, const RecordEntry& entry);
  void finishFirstFlight();
  void refuseFirstFlight();                            // a status other than 200
  void rejectFirstFlight(const std::string& problem);  // a malformed answer
  void dropFlight(std::deque<std::unique_ptr<Flight>>::iterator flight);
  bool dropStale(std::span<const uint32_t> pixels);
  void claimAhead(std::span<const uint32_t> pixels);
  [[nodiscard]] size_t seenNodes(const Flight& flight, std::span<const uint32_t> pixels) const;
  void cancelAll();
  void markUnapplied();

  [[nodiscard]] bool isBusy(NodeIndex node) const;
  void setBusy(NodeIndex node, bool busy);

  const SourceSurroundings to_;
  SelectivelyRefinedMesh& mesh_;
  const std::shared_ptr<const CodeTables> tables_;
  LocalRecords local_;
  std::deque<std::unique_ptr<Flight>> flights_;  // in the order of the requests
  uint64_t lastSequence_ = 0;
  std::vector<uint8_t> busy_;  // by node: asked for, not yet applied
  SplitPlan plan_;
  unsigned plansInRow_ = 0;  // rankings that found something at hand
  std::vector<Wish> queue_;  // ranked, best first, from queueNext_ on
  size_t queueNext_ = 0;
  size_t wished_ = 0;  // by the last ranking, those beyond the queue too
  std::vector<Wish> aheadQueue_;
  std::optional<uint8_t>
      queueExpansion_;          // the queue holds the rest, to be asked for up to this level
  bool restExhausted_ = false;  // nothing left to split, whatever the base promised
  bool expansionRefused_ = false;
  size_t batchLimit_ = SIZE_MAX;  // set where a server refuses larger requests
  unsigned malformedInRow_ = 0;
  RequestBudget budget_;
};

}  // namespace meshfront
