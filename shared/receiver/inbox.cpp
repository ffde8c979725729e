#include "shared/receiver/inbox.h"

#include <utility>

#include "shared/store/entity_tag.h"

namespace meshfront {
namespace {

std::string_view tagOf(const FetchResponse& response) {
  const auto found = response.headers.find("etag");
  return found == response.headers.end() ? std::string_view() : std::string_view(found->second);
}

tl::unexpected<Error> answerToAnotherRequest() {
  return fail("it answers another request, by its entity tag");
}

}  // namespace

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
      if (isTagOfOtherDocument(tagOf(response), response.body))
        arrival.metadata = fail("it is damaged: its digest is not the one in its entity tag");
    }
    arrival.response = std::move(response);
    inbox->put(std::move(arrival));
  };
}

Transport::Completion baseInto(std::shared_ptr<Inbox> inbox, uint32_t key) {
  return [inbox = std::move(inbox), key](FetchResponse response) {
    BaseArrival arrival;
    if (response.status == 200) {
      Result<BaseMesh> base = decodeBaseMesh(response.body);
      arrival.mesh = base ? SelectivelyRefinedMesh::fromBase(std::move(*base))
                          : Result<SelectivelyRefinedMesh>(tl::unexpected(base.error()));
      if (isTagOfOtherResource(tagOf(response), key)) arrival.mesh = answerToAnotherRequest();
    }
    arrival.response = std::move(response);
    inbox->put(std::move(arrival));
  };
}

Transport::Completion recordsInto(std::shared_ptr<Inbox> inbox, uint32_t key, uint64_t sequence,
                                  std::shared_ptr<const RecordRequest> request,
                                  std::shared_ptr<const CodeTables> tables) {
  return [inbox = std::move(inbox), key, sequence, request = std::move(request),
          tables = std::move(tables)](FetchResponse response) {
    RecordsArrival arrival;
    arrival.sequence = sequence;
    if (response.status == 200) {
      arrival.entries = isTagOfOtherResource(tagOf(response), key)
                            ? answerToAnotherRequest()
                            : parseRecords(response.body, *request, *tables);
    }
    arrival.response = std::move(response);
    inbox->put(std::move(arrival));
  };
}

Transport::Completion chunkIndexInto(std::shared_ptr<Inbox> inbox, uint32_t key) {
  return [inbox = std::move(inbox), key](FetchResponse response) {
    ChunkIndexArrival arrival;
    if (response.status == 200) {
      arrival.index = isTagOfOtherResource(tagOf(response), key) ? answerToAnotherRequest()
                                                                 : decodeChunkIndex(response.body);
    }
    arrival.response = std::move(response);
    inbox->put(std::move(arrival));
  };
}

Transport::Completion chunkInto(std::shared_ptr<Inbox> inbox, uint32_t key, uint64_t sequence,
                                std::shared_ptr<const CodeTables> tables) {
  return [inbox = std::move(inbox), key, sequence,
          tables = std::move(tables)](FetchResponse response) {
    ChunkArrival arrival;
    arrival.sequence = sequence;
    if (response.status == 200) {
      arrival.chunk = isTagOfOtherResource(tagOf(response), key)
                          ? answerToAnotherRequest()
                          : decodeChunk(response.body, *tables);
    }
    arrival.response = std::move(response);
    inbox->put(std::move(arrival));
  };
}

}  // namespace meshfront
