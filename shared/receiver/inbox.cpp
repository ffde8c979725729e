#include "shared/receiver/inbox.h"

#include <utility>

namespace meshfront {

void Inbox::put(Arrival arrival) {
  const std::lock_guard lock(mutex_);
  arrivals_.push_back(std::move(arrival));
  arrived_.notify_all();
  if (onArrival_) onArrival_();
}

std::deque<Arrival> Inbox::takeAll() {
  const std::lock_guard lock(mutex_);
  return std::exchange(arrivals_, {});
}

bool Inbox::wait(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  return arrived_.wait_for(lock, timeout, [this] { return !arrivals_.empty(); });
}

void Inbox::close() {
  const std::lock_guard lock(mutex_);
  onArrival_ = nullptr;
}

Transport::Completion metadataInto(std::shared_ptr<Inbox> inbox) {
  return [inbox = std::move(inbox)](FetchResponse response) {
    MetadataArrival arrival;
    if (response.status == 200) {
      arrival.metadata = metadataFromJson(
          {reinterpret_cast<const char*>(response.body.data()), response.body.size()});
    }
    arrival.response = std::move(response);
    inbox->put(std::move(arrival));
  };
}

Transport::Completion baseInto(std::shared_ptr<Inbox> inbox) {
  return [inbox = std::move(inbox)](FetchResponse response) {
    BaseArrival arrival;
    if (response.status == 200) {
      Result<BaseMesh> base = decodeBaseMesh(response.body);
      arrival.mesh = base ? SelectivelyRefinedMesh::fromBase(std::move(*base))
                          : Result<SelectivelyRefinedMesh>(tl::unexpected(base.error()));
    }
    arrival.response = std::move(response);
    inbox->put(std::move(arrival));
  };
}

Transport::Completion recordsInto(std::shared_ptr<Inbox> inbox, uint64_t sequence,
                                  std::shared_ptr<const RecordRequest> request,
                                  std::shared_ptr<const CodeTables> tables) {
  return [inbox = std::move(inbox), sequence, request = std::move(request),
          tables = std::move(tables)](FetchResponse response) {
    RecordsArrival arrival;
    arrival.sequence = sequence;
    if (response.status == 200) arrival.entries = parseRecords(response.body, *request, *tables);
    arrival.response = std::move(response);
    inbox->put(std::move(arrival));
  };
}

Transport::Completion chunkIndexInto(std::shared_ptr<Inbox> inbox) {
  return [inbox = std::move(inbox)](FetchResponse response) {
    ChunkIndexArrival arrival;
    if (response.status == 200) arrival.index = decodeChunkIndex(response.body);
    arrival.response = std::move(response);
    inbox->put(std::move(arrival));
  };
}

Transport::Completion chunkInto(std::shared_ptr<Inbox> inbox, uint64_t sequence,
                                std::shared_ptr<const CodeTables> tables) {
  return [inbox = std::move(inbox), sequence, tables = std::move(tables)](FetchResponse response) {
    ChunkArrival arrival;
    arrival.sequence = sequence;
    if (response.status == 200) arrival.chunk = decodeChunk(response.body, *tables);
    arrival.response = std::move(response);
    inbox->put(std::move(arrival));
  };
}

}  // namespace meshfront
