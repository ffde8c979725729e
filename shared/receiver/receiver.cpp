#include "shared/receiver/receiver.h"

#include <algorithm>
#include <utility>

#include "shared/receiver/inbox.h"
#include "shared/receiver/problem_details.h"
#include "shared/store/entity_tag.h"

namespace meshfront {
namespace {

constexpr size_t kMaxMetadataBytes = 1 << 20;
constexpr uint64_t kMaxBaseBytes = uint64_t{1} << 30;
constexpr unsigned kMaxNotFoundInRow = 3;
// How long the service has to name its revision before a cached one is shown.
constexpr std::chrono::milliseconds kHeadStart{500};

}  // namespace

const char* stateName(ReceiverState state) {
  switch (state) {
    case ReceiverState::connecting:
      return "connecting";
    case ReceiverState::refining:
      return "refining";
    case ReceiverState::settled:
      return "settled";
    case ReceiverState::complete:
      return "complete";
    case ReceiverState::limitReached:
      return "limit reached";
    case ReceiverState::degraded:
      return "degraded";
  }
  return "unknown";
}

Receiver::Receiver(MeshUrl url, ReceiverOptions options, Transport& transport)
    : url_(std::move(url)),
      options_(std::move(options)),
      transport_(transport),
      inbox_(std::make_shared<Inbox>(options_.onArrival)),
      startedAt_(now()),
      movedAt_(startedAt_) {
  if (!options_.cacheFolder.empty())
    cache_ = DiskCache::open(options_.cacheFolder, options_.cacheBytes, url_);
  requestMetadata(false);
}

Receiver::~Receiver() {
  transport_.cancel(setupRequest_);
  source_.reset();
  inbox_->close();
}

bool Receiver::isAtWork() const {
  return state_ == ReceiverState::connecting || state_ == ReceiverState::refining;
}

std::chrono::steady_clock::time_point Receiver::now() const {
  return options_.clock ? options_.clock() : std::chrono::steady_clock::now();
}

void Receiver::forgot(std::span<const NodeId> nodes) {
  if (source_) source_->forgot(nodes);
}

void Receiver::setSplitAllowance(uint64_t splits) {
  const bool wasUsedUp = allowance_.left() == 0;
  allowance_.set(splits);
  if (wasUsedUp && splits > 0) progress_.ranked = false;
  if (source_) updateState();
}

bool Receiver::budgetReached() const {
  return state_ == ReceiverState::limitReached && allowance_.left() == 0;
}

// --- requests ------------------------------------------------------------------------------------

void Receiver::requestMetadata(bool bypassCaches) {
  FetchRequest request;
  request.url = url_.metadata();
  request.maxBodyBytes = kMaxMetadataBytes;
  request.bypassCaches = bypassCaches;
  request.received = received_;
  awaitingMetadata_ = true;
  setupRequest_ = transport_.send(std::move(request), metadataInto(inbox_));
}

void Receiver::requestBase() {
  FetchRequest request;
  request.url = url_.base(metadata_->revision);
  request.maxBodyBytes = static_cast<size_t>(std::min(metadata_->baseBytes, kMaxBaseBytes));
  request.bypassCaches = damagesInRow_ > 0;
  request.received = received_;
  setupRequest_ = transport_.send(std::move(request),
                                  baseInto(inbox_, resourceKey(metadata_->revision, "base")));
}

bool Receiver::mayRequest() const {
  return source_ && !awaitingMetadata_ && state_ != ReceiverState::degraded;
}

void Receiver::requestRecords() {
  if (!mayRequest()) return;
  source_->request();
  meetTrouble();
}

void Receiver::rank(std::span<const uint32_t> pixels, const RankingBias& bias) {
  if (!source_ || (state_ == ReceiverState::degraded && !cache_)) return;
  source_->rank(pixels, bias);
  meetTrouble();
  requestRecords();
  updateState();
}

void Receiver::rankAhead(std::span<const uint32_t> pixels) {
  if (!mayRequest()) return;
  source_->rankAhead(pixels);
  requestRecords();
}

bool Receiver::wantsRanking() const {
  return source_ && (mayRequest() || cache_) && source_->wantsRanking();
}

// --- answers -------------------------------------------------------------------------------------

bool Receiver::waitForArrival(std::chrono::milliseconds timeout) const {
  if (source_ && source_->canApply()) return true;
  return inbox_->wait(timeout);
}

bool Receiver::advance(size_t maxSplits) {
  std::deque<Arrival> arrivals = inbox_->takeAll();
  if (!arrivals.empty()) movedAt_ = now();
  for (Arrival& arrival : arrivals) {
    const FetchResponse& response =
        std::visit([](const auto& any) -> const FetchResponse& { return any.response; }, arrival);
    statistics_.traffic += response.traffic;
    link_.observe(response);
    if (auto* metadata = std::get_if<MetadataArrival>(&arrival)) {
      takeMetadata(std::move(*metadata));
    } else if (auto* base = std::get_if<BaseArrival>(&arrival)) {
      takeBase(std::move(*base));
    } else {
      takeForSource(std::move(arrival));
    }
  }
  bool finished = false;
  const bool rankingFirst = options_.freshRanking && wantsRanking();
  if (source_ && !rankingFirst) {
    finished = source_->apply(maxSplits);
    if (finished) notFoundInRow_ = damagesInRow_ = 0;
    meetTrouble();
  }
  if (!shownCached_ && awaitingMetadata_ && now() - startedAt_ >= kHeadStart) showCached();
  if (cache_) cache_->tick(now());
  requestRecords();
  watch();
  updateState();
  return finished;
}

// Whatever goes wrong elsewhere: nothing is waited for without end.
void Receiver::watch() {
  const bool waiting =
      awaitingMetadata_ || (mesh_ ? source_->isFetching() : state_ != ReceiverState::degraded);
  const uint64_t received = *received_;
  const auto time = now();
  if (!waiting || received != receivedThen_) {
    receivedThen_ = received;
    movedAt_ = time;
  }
  const auto patience = options_.patience;
  if (patience.count() == 0 || time - movedAt_ < patience) return;
  transport_.cancel(setupRequest_);
  movedAt_ = time;
  degradeAlone("nothing has come from " + url_.origin + " for " +
               std::to_string(std::chrono::duration_cast<std::chrono::seconds>(patience).count()) +
               " s");
}

void Receiver::takeForSource(Arrival arrival) {
  const auto* records = std::get_if<RecordsArrival>(&arrival);
  const auto* chunk = std::get_if<ChunkArrival>(&arrival);
  if (records != nullptr || chunk != nullptr) {
    const Traffic& traffic =
        records != nullptr ? records->response.traffic : chunk->response.traffic;
    statistics_.requestBytesUp += traffic.bytesUp;
    statistics_.answerBytesDown += traffic.bodyBytesDown;
  }
  if (!source_) return;
  source_->take(std::move(arrival));
  meetTrouble();
}

void Receiver::takeMetadata(MetadataArrival arrival) {
  awaitingMetadata_ = false;
  const FetchResponse& response = arrival.response;
  if (response.status == 0) {
    degradeAlone(response.error.message);
  } else if (response.status == 404) {
    degrade("there is no mesh '" + url_.name + "' at " + url_.origin + url_.prefix +
                " (the catalogue is /v1/meshes)",
            false);
  } else if (response.status != 200) {
    degradeAlone(url_.origin + " refuses the metadata: " + describeRefusal(response));
  } else if (!arrival.metadata) {
    degradeByDamage(url_.metadata() +
                    " is no mesh of the v1 interface: " + arrival.metadata.error().message);
  } else if (mesh_ && metadata_->revision != arrival.metadata->revision) {
    if (cache_) cache_->keepMetadata(response.body, arrival.metadata->revision);
    degrade("the mesh was published anew: revision " + metadata_->revision + " is now " +
                arrival.metadata->revision + "; connect again to see it",
            true);
  } else {
    if (!metadata_) damagesInRow_ = 0;
    useMetadata(std::move(*arrival.metadata), response.body);
  }
}

void Receiver::useMetadata(MeshMetadata metadata, std::span<const uint8_t> document) {
  metadata_ = std::move(metadata);
  if (cache_) {
    cache_->keepMetadata(document, metadata_->revision);
    cache_->useRevision(metadata_->revision);
  }
  if (mesh_) return;
  if (std::optional<SelectivelyRefinedMesh> mesh = cachedBase()) {
    begin(*metadata_, std::move(*mesh));
  } else {
    requestBase();
  }
}

std::optional<SelectivelyRefinedMesh> Receiver::cachedBase() const {
  const auto bytes = cache_ ? cache_->base() : std::nullopt;
  if (!bytes) return std::nullopt;
  Result<BaseMesh> base = decodeBaseMesh(*bytes);
  if (!base) return std::nullopt;
  Result<SelectivelyRefinedMesh> mesh = SelectivelyRefinedMesh::fromBase(std::move(*base));
  if (!mesh) return std::nullopt;
  return std::move(*mesh);
}

// What was published when the service was last heard of.
void Receiver::showCached() {
  if (mesh_ || !cache_ || std::exchange(shownCached_, true)) return;
  const auto document = cache_->metadata();
  if (!document) return;
  Result<MeshMetadata> metadata =
      metadataFromJson({reinterpret_cast<const char*>(document->data()), document->size()});
  if (!metadata) return;
  cache_->useRevision(metadata->revision);
  if (std::optional<SelectivelyRefinedMesh> mesh = cachedBase())
    begin(std::move(*metadata), std::move(*mesh));
}

void Receiver::begin(MeshMetadata metadata, SelectivelyRefinedMesh mesh) {
  metadata_ = std::move(metadata);
  notFoundInRow_ = damagesInRow_ = 0;
  mesh_ = std::make_unique<SelectivelyRefinedMesh>(std::move(mesh));
  source_ = makeSource({url_, metadata_->revision, options_, transport_, inbox_, *mesh_,
                        statistics_, progress_, allowance_, link_, cache_.get(), received_,
                        metadata_->chunkCount, metadata_->chunkBytes});
}

void Receiver::takeBase(BaseArrival arrival) {
  if (mesh_) return;  // asked for twice, over a resume()
  const FetchResponse& response = arrival.response;
  if (response.status == 0) {
    degradeAlone(response.error.message);
  } else if (response.status == 404) {
    revisionNotFound();
  } else if (response.status != 200) {
    degrade(url_.origin + " refuses the base mesh: " + describeRefusal(response), false);
  } else if (!arrival.mesh) {
    ++statistics_.malformed;
    degradeByDamage("the base mesh is damaged or of another version: " +
                    arrival.mesh.error().message);
  } else {
    if (cache_) cache_->keepBase(response.body);
    begin(std::move(*metadata_), std::move(*arrival.mesh));
  }
}

void Receiver::meetTrouble() {
  std::optional<SourceTrouble> trouble = source_->takeTrouble();
  if (!trouble || state_ == ReceiverState::degraded) return;
  if (trouble->kind == SourceTrouble::Kind::revisionGone) {
    revisionNotFound();
  } else if (trouble->kind == SourceTrouble::Kind::damaged) {
    degradeByDamage(std::move(trouble->reason));
  } else if (trouble->kind == SourceTrouble::Kind::away) {
    degradeAlone(std::move(trouble->reason));
  } else {
    degrade(std::move(trouble->reason), trouble->final);
  }
}

// The server no longer has our revision: see which one it has.
void Receiver::revisionNotFound() {
  if (awaitingMetadata_) return;
  if (++notFoundInRow_ > kMaxNotFoundInRow) {
    degrade(url_.origin + " names revision " + metadata_->revision + " and has none of its records",
            false);
    return;
  }
  requestMetadata(true);
}

// --- state ---------------------------------------------------------------------------------------

void Receiver::updateState() {
  if (state_ == ReceiverState::degraded) return;
  if (!mesh_) {
    state_ = ReceiverState::connecting;
  } else if (mesh_->complete()) {
    state_ = ReceiverState::complete;
  } else if (progress_.settled && source_->idle() && !progress_.completing) {
    state_ = ReceiverState::settled;
  } else if (source_->idle() && !awaitingMetadata_ && source_->limitReached()) {
    state_ = ReceiverState::limitReached;
  } else if (source_->idle() && progress_.completing && source_->exhausted()) {
    degrade("the base mesh promises " + std::to_string(mesh_->splitCount()) +
                " records, and only " + std::to_string(mesh_->splitsApplied()) + " exist",
            true);
  } else {
    state_ = ReceiverState::refining;
  }
}

void Receiver::degrade(std::string reason, bool final) {
  if (source_) source_->giveUp();
  awaitingMetadata_ = false;
  state_ = ReceiverState::degraded;
  reason_ = std::move(reason);
  final_ = final;
}

void Receiver::degradeAlone(std::string reason) {
  showCached();
  if (cache_ && mesh_) reason += "; offline, showing what the disk cache holds";
  degrade(std::move(reason), false);
}

void Receiver::degradeByDamage(std::string reason) {
  degrade(std::move(reason), ++damagesInRow_ >= kMostDamages);
}

bool Receiver::resume() {
  if (state_ != ReceiverState::degraded || final_) return false;
  state_ = mesh_ ? ReceiverState::refining : ReceiverState::connecting;
  reason_.clear();
  notFoundInRow_ = 0;
  progress_.settled = false;
  progress_.ranked = false;
  // Always anew: the server may have come back with another revision.
  requestMetadata(true);
  return true;
}

}  // namespace meshfront
