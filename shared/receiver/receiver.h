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
// counts, ask for the records of the first ones, or for the chunks that hold them (FetchMode),
// apply the answers in the order of the requests, rank again. What is under way is not asked for
// again. Everything a request holds is a constant of the mesh, so that a cache may answer it.
//
// Between two calls the mesh's owner may collapse, split again and forget nodes (meshToRefine()),
// and say how many further splits its budgets allow.
//
// With a disk cache the mesh begins as it was published last where the service is away or takes
// long to say what it has now, and is refined from the cache, even while degraded, whatever view is
// ranked. A revision that turns out to be another one is used at once if nothing was shown yet.
//
// Threads: a Receiver belongs to one thread. Answers are taken in and decoded on the transport's
// thread and wait in an inbox for advance(). The transport must outlive the receiver.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "shared/receiver/disk_cache.h"
#include "shared/receiver/link_meter.h"
#include "shared/receiver/mesh_url.h"
#include "shared/receiver/receiver_options.h"
#include "shared/receiver/record_source.h"
#include "shared/receiver/transport.h"
#include "shared/refinement/selectively_refined_mesh.h"
#include "shared/store/mesh_metadata.h"

namespace meshfront {

class Inbox;
struct MetadataArrival;
struct BaseArrival;

enum class ReceiverState {
  connecting,    // no mesh yet
  refining,      // there is something to ask for, or something under way
  settled,       // every splittable front vertex that covers a pixel has been split
  complete,      // the full mesh is here
  limitReached,  // ReceiverLimits, or the split allowance, forbid to ask for more
  degraded,      // stuck; reason() says why, and the mesh stays usable as it is
};
[[nodiscard]] const char* stateName(ReceiverState state);

class Receiver {
 public:
  Receiver(MeshUrl url, ReceiverOptions options, Transport& transport);
  ~Receiver();
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  [[nodiscard]] FetchMode mode() const { return options_.mode; }
  [[nodiscard]] ReceiverState state() const { return state_; }
  [[nodiscard]] const std::string& reason() const { return reason_; }  // of degraded
  // Connecting or refining: waiting for arrivals makes sense.
  [[nodiscard]] bool isAtWork() const;

  // Null while connecting. Of the receiver's own calls only advance() changes it.
  [[nodiscard]] const SelectivelyRefinedMesh* mesh() const { return mesh_.get(); }
  // For whoever keeps the mesh within budgets, between two calls. Nodes that are pinned stay known.
  [[nodiscard]] SelectivelyRefinedMesh* meshToRefine() { return mesh_.get(); }
  // Nodes have been forgotten by the owner, and their indices may be used for others. To be called
  // before any other call. Their records are asked for again when a view needs them.
  void forgot(std::span<const NodeId> nodes);
  // How many further splits there may be, of whatever record; UINT64_MAX (at first): any number.
  // Beyond that nothing is asked for either, and a view that needs more ends as limitReached.
  void setSplitAllowance(uint64_t splits);
  // Of limitReached: it is the allowance that is used up.
  [[nodiscard]] bool budgetReached() const;
  [[nodiscard]] const MeshMetadata* metadata() const { return metadata_ ? &*metadata_ : nullptr; }
  [[nodiscard]] const ReceiverStatistics& statistics() const { return statistics_; }
  [[nodiscard]] size_t requestsUnderWay() const {
    return source_ ? source_->requestsUnderWay() : 0;
  }
  // What the way to the service is like, as far as answers have told.
  [[nodiscard]] const LinkMeter& link() const { return link_; }
  // Requests that may be under way at once, as of now.
  [[nodiscard]] uint32_t window() const { return source_ ? source_->window() : 1; }
  // Null without a disk cache.
  [[nodiscard]] const DiskCache* cache() const { return cache_.get(); }
  // Visible candidates at the last ranking.
  [[nodiscard]] size_t visibleCandidateCount() const { return progress_.visible; }

  // Takes in what arrived: at most one answer, and at most `maxSplits` of it; the rest keeps for
  // the next call. True when an answer has been applied to its end.
  bool advance(size_t maxSplits = SIZE_MAX);
  // True when advance() has something to do.
  bool waitForArrival(std::chrono::milliseconds timeout) const;

  // The mesh changed since the last ranking, and a request could be sent if there were a new one.
  // False while what no view shows is fetched; rank() puts what a new view shows in front of that.
  [[nodiscard]] bool wantsRanking() const;
  // `pixels`: counts by vertex slot of mesh() as it is now. Sends what there is room for.
  void rank(std::span<const uint32_t> pixels, const RankingBias& bias = {});
  // Counts of a view that may come. What it needs is fetched while the view of rank() needs
  // nothing; state() does not tell of it.
  void rankAhead(std::span<const uint32_t> pixels);

  // Leaves degraded where trying again may help (a server that was away or sent damaged answers);
  // false where it cannot (the mesh was published anew, kMostDamages in a row).
  static constexpr unsigned kMostDamages = 12;
  bool resume();
  [[nodiscard]] bool canResume() const { return state_ == ReceiverState::degraded && !final_; }

 private:
  [[nodiscard]] std::chrono::steady_clock::time_point now() const;
  void requestMetadata(bool bypassCaches);
  void requestBase();
  void requestRecords();
  [[nodiscard]] bool mayRequest() const;

  void takeMetadata(MetadataArrival arrival);
  void takeBase(BaseArrival arrival);
  void takeForSource(Arrival arrival);
  void begin(MeshMetadata metadata, SelectivelyRefinedMesh mesh);
  void useMetadata(MeshMetadata metadata, std::span<const uint8_t> document);
  [[nodiscard]] std::optional<SelectivelyRefinedMesh> cachedBase() const;
  void showCached();
  void meetTrouble();
  void watch();
  void revisionNotFound();
  void updateState();
  void degrade(std::string reason, bool final);
  void degradeAlone(std::string reason);  // the service is away: the cache has to do
  void degradeByDamage(std::string reason);

  const MeshUrl url_;
  const ReceiverOptions options_;
  Transport& transport_;
  std::shared_ptr<Inbox> inbox_;
  const std::shared_ptr<std::atomic<uint64_t>> received_ =
      std::make_shared<std::atomic<uint64_t>>(0);  // octets, of all requests

  ReceiverState state_ = ReceiverState::connecting;
  std::string reason_;
  bool final_ = false;  // degraded for good
  std::optional<MeshMetadata> metadata_;
  std::unique_ptr<DiskCache> cache_;
  const std::chrono::steady_clock::time_point startedAt_;
  bool shownCached_ = false;  // tried to
  std::unique_ptr<SelectivelyRefinedMesh> mesh_;
  ViewProgress progress_;
  ReceiverStatistics statistics_;
  SplitAllowance allowance_;
  LinkMeter link_;
  std::unique_ptr<RecordSource> source_;  // from the base mesh on
  FetchId setupRequest_ = 0;              // metadata or base under way
  bool awaitingMetadata_ = false;         // no records are asked for meanwhile
  unsigned notFoundInRow_ = 0;
  unsigned damagesInRow_ = 0;  // since it last got further
  // When something last came, or was first waited for.
  std::chrono::steady_clock::time_point movedAt_;
  uint64_t receivedThen_ = 0;
};

}  // namespace meshfront
