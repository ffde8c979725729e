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
      inbox_(std::make_shared<Inbox>(options_.onArrival)) {
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

// --- requests ------------------------------------------------------------------------------------

void Receiver::requestMetadata(bool bypassCaches) {
  FetchRequest request;
  request.url = url_.metadata();
  request.maxBodyBytes = kMaxMetadataBytes;
  request.bypassCaches = bypassCaches;
  awaitingMetadata_ = true;
  setupRequest_ = transport_.send(std::move(request), metadataInto(inbox_));
}

void Receiver::requestBase() {
  FetchRequest request;
  request.url = url_.base(metadata_->revision);
  request.maxBodyBytes = static_cast<size_t>(std::min(metadata_->baseBytes, kMaxBaseBytes));
  request.bypassCaches = damagesInRow_ > 0;
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

void Receiver::rank(std::span<const uint32_t> pixels) {
  if (!source_ || state_ == ReceiverState::degraded) return;
  source_->rank(pixels);
  meetTrouble();
  requestRecords();
  updateState();
}

bool Receiver::wantsRanking() const {
  return mayRequest() && source_->wantsRanking();
}

// --- answers -------------------------------------------------------------------------------------

bool Receiver::waitForArrival(std::chrono::milliseconds timeout) const {
  if (source_ && source_->canApply()) return true;
  return inbox_->wait(timeout);
}

bool Receiver::advance(size_t maxSplits) {
  for (Arrival& arrival : inbox_->takeAll()) {
    statistics_.traffic +=
        std::visit([](const auto& any) -> const Traffic& { return any.response.traffic; }, arrival);
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
  if (source_ && state_ != ReceiverState::degraded && !rankingFirst) {
    finished = source_->apply(maxSplits);
    if (finished) notFoundInRow_ = damagesInRow_ = 0;
    meetTrouble();
  }
  requestRecords();
  updateState();
  return finished;
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
    degrade(response.error.message, false);
  } else if (response.status == 404) {
    degrade("there is no mesh '" + url_.name + "' at " + url_.origin + url_.prefix +
                " (the catalogue is /v1/meshes)",
            false);
  } else if (response.status != 200) {
    degrade(url_.origin + " refuses the metadata: " + describeRefusal(response), false);
  } else if (!arrival.metadata) {
    degradeByDamage(url_.metadata() +
                    " is no mesh of the v1 interface: " + arrival.metadata.error().message);
  } else if (mesh_ && metadata_->revision != arrival.metadata->revision) {
    degrade("the mesh was published anew: revision " + metadata_->revision + " is now " +
                arrival.metadata->revision + "; connect again to see it",
            true);
  } else {
    if (!metadata_) damagesInRow_ = 0;
    metadata_ = std::move(*arrival.metadata);
    if (!mesh_) requestBase();
  }
}

void Receiver::takeBase(BaseArrival arrival) {
  if (mesh_) return;  // asked for twice, over a resume()
  const FetchResponse& response = arrival.response;
  if (response.status == 0) {
    degrade(response.error.message, false);
  } else if (response.status == 404) {
    revisionNotFound();
  } else if (response.status != 200) {
    degrade(url_.origin + " refuses the base mesh: " + describeRefusal(response), false);
  } else if (!arrival.mesh) {
    ++statistics_.malformed;
    degradeByDamage("the base mesh is damaged or of another version: " +
                    arrival.mesh.error().message);
  } else {
    notFoundInRow_ = damagesInRow_ = 0;
    mesh_ = std::make_unique<SelectivelyRefinedMesh>(std::move(*arrival.mesh));
    source_ = makeSource({url_, metadata_->revision, options_, transport_, inbox_, *mesh_,
                          statistics_, progress_, metadata_->chunkCount, metadata_->chunkBytes});
  }
}

void Receiver::meetTrouble() {
  std::optional<SourceTrouble> trouble = source_->takeTrouble();
  if (!trouble || state_ == ReceiverState::degraded) return;
  if (trouble->kind == SourceTrouble::Kind::revisionGone) {
    revisionNotFound();
  } else if (trouble->kind == SourceTrouble::Kind::damaged) {
    degradeByDamage(std::move(trouble->reason));
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
