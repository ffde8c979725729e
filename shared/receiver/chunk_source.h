// Asks for whole chunks, those first whose roots cover most pixels.
//   rank     fresh pixel counts -> ready_: visible nodes whose records are held or at hand
//                               -> queue_ of chunks that hold the others' records, best first
//   request  queue_ -> flights_, one request each
//   apply    the first flight's chunk -> held_; its wanted nodes -> ready_ -> splits
// A record that is held is never asked for again. A split node's children are split along with it
// where their records are held, because a part that is seen is then as fine as what was paid for
// allows, without a ranking for each generation. Flights are applied in the order of the requests,
// as ExactSource does and for the same reason; between two calls the mesh's owner may collapse and
// split nodes likewise.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shared/codec/chunk.h"
#include "shared/receiver/held_chunks.h"
#include "shared/receiver/local_records.h"
#include "shared/receiver/ranking.h"
#include "shared/receiver/record_source.h"
#include "shared/receiver/split_plan.h"

namespace meshfront {

class ChunkSource final : public RecordSource {
 public:
  explicit ChunkSource(SourceSurroundings surroundings);
  ~ChunkSource() override;

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
  [[nodiscard]] bool limitReached() const override;
  [[nodiscard]] bool exhausted() const override;
  [[nodiscard]] bool isFetching() const override;
  [[nodiscard]] uint32_t window() const override { return windowNow(to_); }
  [[nodiscard]] size_t requestsUnderWay() const override { return flights_.size(); }

 private:
  struct Flight {
    uint64_t sequence = 0;
    uint32_t chunk = 0;
    FetchId id = 0;
    bool ahead = false;                   // for a view that may come
    std::optional<ChunkArrival> arrival;  // else under way
  };
  struct Place {  // of a node's record
    Candidate candidate;
    uint32_t chunk = 0;
  };

  void requestIndex(bool bypassCaches);
  void adoptIndex(ChunkIndex index);
  void takeIndex(ChunkIndexArrival arrival);
  Flight& send(uint32_t chunk, bool bypassCaches);
  void requestAhead();
  [[nodiscard]] bool mayAsk() const;

  void planView(std::span<const Candidate> visible, size_t atMost);
  void planRest();
  // The chunks that are neither held nor under way, best first; places of all candidates go to
  // `places`, if given. False: trouble.
  bool rankChunks(std::span<const Candidate> candidates, std::vector<uint32_t>& chunks,
                  std::vector<Place>* places);
  void dropStale(std::span<const Candidate> visible);
  // Its record can be had without a request.
  [[nodiscard]] bool isAtHand(NodeIndex node);
  // From a chunk that is held. One that is used up counts as not held from then on.
  [[nodiscard]] bool isHeld(NodeIndex node);
  // Where the node's record is; nullopt where the index has none for it: trouble, then.
  [[nodiscard]] std::optional<uint32_t> chunkOf(NodeIndex node);
  bool takeFirstFlight();
  [[nodiscard]] std::string faultOf(uint32_t number, const Chunk& chunk) const;
  void makeReady(uint32_t chunk);
  bool applyReady(size_t maxSplits);
  [[nodiscard]] bool readyWaits() const { return !ready_.empty() && to_.allowance.left() > 0; }
  bool split(NodeIndex node, std::optional<uint32_t> chunk);
  void addChildren(const Candidate& parent);
  void reject(uint32_t chunk, const std::string& problem);
  void cancelAll();
  void forgetPlans();

  const SourceSurroundings to_;
  SelectivelyRefinedMesh& mesh_;
  const std::shared_ptr<const CodeTables> tables_;
  RequestBudget budget_;

  std::optional<ChunkIndex> index_;
  FetchId indexRequest_ = 0;  // 0: not under way
  bool indexRejected_ = false;
  std::vector<NodeId> firstNodes_;  // by chunk
  std::vector<uint8_t> bands_;      // by chunk
  HeldChunks held_{0};
  std::vector<uint8_t> underWay_;  // by chunk
  std::vector<uint8_t> rejected_;  // by chunk: its one repetition is used up
  uint64_t longestChunk_ = 0;      // octets

  std::deque<Flight> flights_;  // in the order of the requests
  uint64_t lastSequence_ = 0;
  std::vector<uint32_t> queue_;  // chunks, best first, from queueNext_ on
  size_t queueNext_ = 0;
  std::vector<Place> waiting_;  // visible nodes whose chunks are not here
  LocalRecords local_;
  SplitPlan ready_;                   // to be split
  std::vector<uint32_t> aheadQueue_;  // chunks, best first
  unsigned plansInRow_ = 0;           // rankings that found something at hand
  bool restPlanned_ = false;          // the queue holds all that no view asked for
};

}  // namespace meshfront
