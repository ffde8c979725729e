// Refines a mesh for one viewer: it decides what to ask for, and nobody else needs to know.
//
//   HttpFetcher http;
//   Receiver receiver(*parseMeshUrl(url), {}, http);
//   while (receiver.isAtWork()) {
//     receiver.waitForArrival(100ms);
//     receiver.advance();                             // applies what arrived
//     if (const auto* mesh = receiver.mesh()) receiver.rank(pixelsBySlot(*mesh));
//   }
//
// The cycle: metadata -> revision -> base mesh; then rank the front's visible vertices by pixel
// counts, ask for the records of the first ones, apply the answers in the order of the requests,
// rank again. Nodes under way are not asked for again. Everything a request holds is a constant of
// the mesh, so that a cache may answer it.
//
// Threads: a Receiver belongs to one thread. Answers are taken in and decoded on the transport's
// thread and wait in an inbox for advance(). The transport must outlive the receiver.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/receiver/mesh_url.h"
#include "shared/receiver/ranking.h"
#include "shared/receiver/record_request.h"
#include "shared/receiver/request_budget.h"
#include "shared/receiver/transport.h"
#include "shared/refinement/selectively_refined_mesh.h"
#include "shared/store/mesh_metadata.h"

namespace meshfront {

class Inbox;
struct MetadataArrival;
struct BaseArrival;
struct RecordsArrival;

enum class ReceiverState {
  connecting,    // no mesh yet
  refining,      // there is something to ask for, or something under way
  settled,       // every splittable front vertex that covers a pixel has been split
  complete,      // the full mesh is here
  limitReached,  // ReceiverLimits forbid to ask for more
  degraded,      // stuck; reason() says why, and the mesh stays usable as it is
};
[[nodiscard]] const char* stateName(ReceiverState state);

struct ReceiverOptions {
  enum class Goal {
    settled,  // what the views show
    complete  // when that is there: the rest
  };
  RankOrder order = RankOrder::significance;
  Goal goal = Goal::settled;
  uint32_t batch = 0;   // records a request; 0: adaptiveBatch()
  uint32_t window = 2;  // requests under way, >= 1
  // After each answer advance() waits for a ranking before it applies the next one: the requests
  // then depend on the mesh and the views alone, at the price of a count for each answer. Else
  // rankings are used up, and the caller ranks when it likes.
  bool freshRanking = true;
  ReceiverLimits limits;
  // Called on a thread of the transport when advance() has something to do. Must only wake.
  std::function<void()> onArrival;
};

struct ReceiverStatistics {
  uint64_t requests = 0;  // for records, repeated ones too
  uint64_t answers = 0;   // applied whole
  uint64_t records = 0;   // applied
  uint64_t malformed = 0;
  uint64_t idsRequested = 0;                   // nodes named in requests
  uint64_t setOctets = 0;                      // of their bitstrings, before base64url
  uint64_t requestBytesUp = 0;                 // of record requests alone: lines, headers, content
  uint64_t answerBytesDown = 0;                // of record answers alone, without headers
  Traffic traffic;                             // everything
  std::optional<uint64_t> recordsWhenSettled;  // the first time
};

class Receiver {
 public:
  Receiver(MeshUrl url, ReceiverOptions options, Transport& transport);
  ~Receiver();
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  [[nodiscard]] ReceiverState state() const { return state_; }
  [[nodiscard]] const std::string& reason() const { return reason_; }  // of degraded
  // Connecting or refining: waiting for arrivals makes sense.
  [[nodiscard]] bool isAtWork() const;

  // Null while connecting. Changes in advance() only.
  [[nodiscard]] const SelectivelyRefinedMesh* mesh() const { return mesh_.get(); }
  [[nodiscard]] const MeshMetadata* metadata() const { return metadata_ ? &*metadata_ : nullptr; }
  [[nodiscard]] const ReceiverStatistics& statistics() const { return statistics_; }
  [[nodiscard]] size_t requestsUnderWay() const { return flights_.size(); }
  // Visible candidates at the last ranking.
  [[nodiscard]] size_t visibleCandidateCount() const { return visibleCount_; }

  // Takes in what arrived: at most one answer, and at most `maxSplits` of it; the rest keeps for
  // the next call. True when an answer has been applied to its end.
  bool advance(size_t maxSplits = SIZE_MAX);
  // True when advance() has something to do.
  bool waitForArrival(std::chrono::milliseconds timeout) const;

  // The mesh changed since the last ranking, and a request could be sent if there were a new one.
  // False while what no view shows is fetched;
  // rank() puts what a new view shows in front of that.
  [[nodiscard]] bool wantsRanking() const;
  // `pixels`: counts by vertex slot of mesh() as it is now. Sends what there is room for.
  void rank(std::span<const uint32_t> pixels);

  // Leaves degraded where trying again may help (a server that was away); false where it cannot
  // (the mesh was published anew, a server that sends damaged answers).
  bool resume();

 private:
  struct Flight;

  void requestMetadata(bool bypassCaches);
  void requestBase();
  void send(Flight& flight, bool bypassCaches);
  void fillWindow();
  void refillFromRest();
  [[nodiscard]] uint64_t pendingRecords() const;
  [[nodiscard]] size_t batchSize() const;
  [[nodiscard]] bool mayRequest() const;

  void takeMetadata(MetadataArrival arrival);
  void takeBase(BaseArrival arrival);
  bool applyFirstFlight(size_t& maxSplits);
  void finishFirstFlight();
  void refuseFirstFlight();                            // a status other than 200
  void rejectFirstFlight(const std::string& problem);  // a malformed answer
  void dropFirstFlight();
  void revisionNotFound();
  void markUnapplied();

  [[nodiscard]] bool isBusy(NodeIndex node) const;
  void setBusy(NodeIndex node, bool busy);
  void updateState();
  void degrade(std::string reason, bool final);

  const MeshUrl url_;
  const ReceiverOptions options_;
  Transport& transport_;
  std::shared_ptr<Inbox> inbox_;

  ReceiverState state_ = ReceiverState::connecting;
  std::string reason_;
  bool final_ = false;  // degraded for good
  std::optional<MeshMetadata> metadata_;
  std::unique_ptr<SelectivelyRefinedMesh> mesh_;
  std::shared_ptr<const CodeTables> tables_;
  FetchId setupRequest_ = 0;       // metadata or base under way
  bool awaitingMetadata_ = false;  // no records are asked for meanwhile
  unsigned notFoundInRow_ = 0;

  std::deque<std::unique_ptr<Flight>> flights_;  // in the order of the requests
  uint64_t lastSequence_ = 0;
  std::vector<uint8_t> busy_;     // by node: asked for, not yet applied
  std::vector<NodeIndex> queue_;  // ranked, best first, from queueNext_ on
  size_t queueNext_ = 0;
  std::optional<uint8_t>
      queueExpansion_;          // the queue holds the rest, to be asked for up to this level
  bool completing_ = false;     // settled once; goal complete
  bool restExhausted_ = false;  // nothing left to split, whatever the base promised
  bool settledView_ = false;    // the last ranking saw nothing to split
  bool ranked_ = false;         // since the last answer
  bool expansionRefused_ = false;
  size_t batchLimit_ = SIZE_MAX;  // set where a server refuses larger requests
  unsigned malformedInRow_ = 0;
  size_t visibleCount_ = 0;
  RequestBudget budget_;
  ReceiverStatistics statistics_;
};

}  // namespace meshfront
