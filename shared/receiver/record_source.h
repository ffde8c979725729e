// Where a receiver's records come from: what to ask for next, the requests under way, and how their
// answers become splits of the mesh. ExactSource asks for sets of nodes, ChunkSource for chunks.
// Belongs to the receiver's thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "shared/receiver/inbox.h"
#include "shared/receiver/link_meter.h"
#include "shared/receiver/mesh_url.h"
#include "shared/receiver/receiver_options.h"
#include "shared/receiver/split_allowance.h"
#include "shared/refinement/selectively_refined_mesh.h"

namespace meshfront {

class DiskCache;

// How far the view is, as the last ranking saw it.
struct ViewProgress {
  bool ranked = false;      // since the last answer
  bool settled = false;     // nothing visible was left to split, and nothing under way
  bool completing = false;  // settled, and the goal is all of the mesh
  size_t visible = 0;       // candidates

  // Takes in a ranking. `idle`: nothing under way or still to be applied.
  void see(size_t visibleCandidates, bool idle, const ReceiverOptions& options,
           ReceiverStatistics& statistics);
};

// All of it outlives the source.
struct SourceSurroundings {
  const MeshUrl& url;
  std::string revision;
  const ReceiverOptions& options;
  Transport& transport;
  std::shared_ptr<Inbox> inbox;
  SelectivelyRefinedMesh& mesh;
  ReceiverStatistics& statistics;
  ViewProgress& progress;
  SplitAllowance& allowance;
  LinkMeter& link;
  DiskCache* cache = nullptr;                       // of this revision; null: none
  std::shared_ptr<std::atomic<uint64_t>> received;  // for every request
  uint64_t chunkCount = 0;                          // as the metadata says: untrusted
  uint64_t chunkBytes = 0;
};
// Requests that may be under way now, >= 1: measured where that is wanted, else windowOf().
[[nodiscard]] uint32_t windowNow(const SourceSurroundings& to);

// Why a source cannot go on as it is.
struct SourceTrouble {
  enum class Kind {
    revisionGone,  // the server has none of this revision
    away,          // no answer
    damaged,       // an answer twice in a row, or one to another request: may heal
    failed
  };
  Kind kind = Kind::failed;
  std::string reason;
  bool final = false;  // trying again cannot help
};

class RecordSource {
 public:
  RecordSource() = default;
  virtual ~RecordSource() = default;
  [[nodiscard]] virtual uint32_t window() const = 0;  // requests that may be under way now
  RecordSource(const RecordSource&) = delete;
  RecordSource& operator=(const RecordSource&) = delete;

  // Takes an answer over; those to requests given up are dropped.
  virtual void take(Arrival arrival) = 0;
  // Fresh counts by vertex slot. Updates the view's progress; sends nothing.
  virtual void rank(std::span<const uint32_t> pixels, const RankingBias& bias) = 0;
  // The same of a view that may come: what it wants is asked for, one request at a time, while the
  // view of rank() lacks nothing, and is given up as soon as that wants something.
  virtual void rankAhead(std::span<const uint32_t> pixels) = 0;
  // Sends what there is room for.
  virtual void request() = 0;
  // Splits what has arrived, at most `maxSplits` times. True when something, such as an answer, has
  // been applied to its end.
  virtual bool apply(size_t maxSplits) = 0;
  // Breaks off all requests and forgets what was to be asked for.
  virtual void giveUp() = 0;
  // The mesh has forgotten nodes, whose indices may mean others from now on. Drops all plans.
  virtual void forgot(std::span<const NodeId> nodes) = 0;

  [[nodiscard]] virtual bool canApply() const = 0;
  [[nodiscard]] virtual bool hasRoom() const = 0;       // for one more request
  [[nodiscard]] virtual bool wantsRanking() const = 0;  // has used up what it knows of the view
  // Nothing for the view under way or still to be applied, as far as the allowance goes.
  [[nodiscard]] virtual bool idle() const = 0;
  [[nodiscard]] virtual bool limitReached() const = 0;  // limits forbid to ask for more
  [[nodiscard]] virtual bool exhausted() const = 0;     // nothing is left to ask for
  [[nodiscard]] virtual bool isFetching() const = 0;    // an answer is being waited for
  [[nodiscard]] virtual size_t requestsUnderWay() const = 0;

  // What went wrong in the last call, once.
  [[nodiscard]] std::optional<SourceTrouble> takeTrouble();

 protected:
  [[nodiscard]] bool inTrouble() const { return trouble_.has_value(); }
  void report(SourceTrouble trouble) { trouble_ = std::move(trouble); }
  // What a status other than 200 means. `what`: "a request for records".
  void reportRefusal(const MeshUrl& url, const FetchResponse& response, const std::string& what);

 private:
  std::optional<SourceTrouble> trouble_;
};

[[nodiscard]] std::unique_ptr<RecordSource> makeSource(SourceSurroundings surroundings);

}  // namespace meshfront
