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
// Threads: a Receiver belongs to one thread. Answers are taken in and decoded on the transport's
// thread and wait in an inbox for advance(). The transport must outlive the receiver.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

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
  limitReached,  // ReceiverLimits forbid to ask for more
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

  // Null while connecting. Changes in advance() only.
  [[nodiscard]] const SelectivelyRefinedMesh* mesh() const { return mesh_.get(); }
  [[nodiscard]] const MeshMetadata* metadata() const { return metadata_ ? &*metadata_ : nullptr; }
  [[nodiscard]] const ReceiverStatistics& statistics() const { return statistics_; }
  [[nodiscard]] size_t requestsUnderWay() const {
    return source_ ? source_->requestsUnderWay() : 0;
  }
  // Visible candidates at the last ranking.
  [[nodiscard]] size_t visibleCandidateCount() const { return progress_.visible; }

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

  // Leaves degraded where trying again may help (a server that was away or sent damaged answers);
  // false where it cannot (the mesh was published anew, kMostDamages in a row).
  static constexpr unsigned kMostDamages = 12;
  bool resume();

 private:
  void requestMetadata(bool bypassCaches);
  void requestBase();
  void requestRecords();
  [[nodiscard]] bool mayRequest() const;

  void takeMetadata(MetadataArrival arrival);
  void takeBase(BaseArrival arrival);
  void takeForSource(Arrival arrival);
  void meetTrouble();
  void revisionNotFound();
  void updateState();
  void degrade(std::string reason, bool final);
  void degradeByDamage(std::string reason);

  const MeshUrl url_;
  const ReceiverOptions options_;
  Transport& transport_;
  std::shared_ptr<Inbox> inbox_;

  ReceiverState state_ = ReceiverState::connecting;
  std::string reason_;
  bool final_ = false;  // degraded for good
  std::optional<MeshMetadata> metadata_;
  std::unique_ptr<SelectivelyRefinedMesh> mesh_;
  ViewProgress progress_;
  ReceiverStatistics statistics_;
  std::unique_ptr<RecordSource> source_;  // from the base mesh on
  FetchId setupRequest_ = 0;              // metadata or base under way
  bool awaitingMetadata_ = false;         // no records are asked for meanwhile
  unsigned notFoundInRow_ = 0;
  unsigned damagesInRow_ = 0;  // since it last got further
};

}  // namespace meshfront
