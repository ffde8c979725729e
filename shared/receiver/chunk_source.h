// Asks for whole chunks, those first whose roots cover most pixels.
//   rank     fresh pixel counts -> ready_: visible nodes whose records are held
//                               -> queue_ of chunks that hold the others' records, best first
//   request  queue_ -> flights_, one request each
//   apply    the first flight's chunk -> held_; its wanted nodes -> ready_ -> splits
// A record that is held is never asked for again. A split node's children are split along with it
// where their records are held, because a part that is seen is then as fine as what was paid for
// allows, without a ranking for each generation. Flights are applied in the order of the requests,
// as ExactSource does and for the same reason.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shared/codec/chunk.h"
#include "shared/receiver/held_chunks.h"
#include "shared/receiver/ranking.h"
#include "shared/receiver/record_source.h"

namespace meshfront {

class ChunkSource final : public RecordSource {
 public:
  explicit ChunkSource(SourceSurroundings surroundings);
  ~ChunkSource() override;

  void take(Arrival arrival) override;
  void rank(std::span<const uint32_t> pixels) override;
  void request() override;
  bool apply(size_t maxSplits) override;
  void giveUp() override;
  [[nodiscard]] bool canApply() const override;
  [[nodiscard]] bool hasRoom() const override;
  [[nodiscard]] bool wantsRanking() const override;
  [[nodiscard]] bool idle() const override;
  [[nodiscard]] bool limitReached() const override;
  [[nodiscard]] bool exhausted() const override;
  [[nodiscard]] size_t requestsUnderWay() const override { return flights_.size(); }

 private:
  struct Flight {
    uint64_t sequence = 0;
    uint32_t chunk = 0;
    FetchId id = 0;
    std::optional<ChunkArrival> arrival;  // else under way
  };
  struct Place {  // of a node's record
    NodeIndex node = kNone;
    uint32_t chunk = 0;
  };

  void requestIndex(bool bypassCaches);
  void takeIndex(ChunkIndexArrival arrival);
  void send(uint32_t chunk, bool bypassCaches);
  [[nodiscard]] bool mayAsk() const;

  void planView(std::span<const Candidate> visible);
  void planRest();
  // Where the node's record is; nullopt where the index has none for it: trouble, then.
  [[nodiscard]] std::optional<uint32_t> chunkOf(NodeIndex node);
  bool takeFirstFlight();
  [[nodiscard]] std::string faultOf(uint32_t number, const Chunk& chunk) const;
  void makeReady(uint32_t chunk);
  bool applyReady(size_t maxSplits);
  bool split(const Place& place);
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
  std::vector<Place> ready_;    // to be split, from readyNext_ on
  size_t readyNext_ = 0;
  bool restPlanned_ = false;  // the queue holds all that no view asked for
};

}  // namespace meshfront
