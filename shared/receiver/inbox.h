// Between the transport's threads, which take answers in and decode them, and the receiver's own,
// which applies them. Everything that runs on a transport's thread is here.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <variant>
#include <vector>

#include "shared/codec/chunk.h"
#include "shared/receiver/record_request.h"
#include "shared/receiver/transport.h"
#include "shared/refinement/selectively_refined_mesh.h"
#include "shared/store/mesh_metadata.h"

namespace meshfront {

// The decoded part is of a meaning only where the status is 200.
struct MetadataArrival {
  FetchResponse response;
  Result<MeshMetadata> metadata = fail("no metadata");
};
struct BaseArrival {
  FetchResponse response;
  Result<SelectivelyRefinedMesh> mesh = fail("no base mesh");
};
struct RecordsArrival {
  uint64_t sequence = 0;  // of the flight
  FetchResponse response;
  Result<std::vector<RecordEntry>> entries = fail("no records");  // offsets into response.body
};
struct ChunkIndexArrival {
  FetchResponse response;
  Result<ChunkIndex> index = fail("no chunk index");
};
struct ChunkArrival {
  uint64_t sequence = 0;  // of the flight
  FetchResponse response;
  Result<Chunk> chunk = fail("no chunk");  // offsets into response.body
};
using Arrival =
    std::variant<MetadataArrival, BaseArrival, RecordsArrival, ChunkIndexArrival, ChunkArrival>;

// Thread-safe. Completions share it and may outlive the receiver.
class Inbox {
 public:
  explicit Inbox(std::function<void()> onArrival) : onArrival_(std::move(onArrival)) {}

  void put(Arrival arrival);
  [[nodiscard]] std::deque<Arrival> takeAll();
  // False: nothing came in time.
  [[nodiscard]] bool wait(std::chrono::milliseconds timeout);
  // No onArrival from now on; waits for one under way.
  void close();

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Arrival> arrivals_;
  std::function<void()> onArrival_;
};

// Completions that decode an answer and put it in. `key`: of the resource asked for; an answer
// whose entity tag names another one (entity_tag.h) is malformed.
[[nodiscard]] Transport::Completion metadataInto(std::shared_ptr<Inbox> inbox);
[[nodiscard]] Transport::Completion baseInto(std::shared_ptr<Inbox> inbox, uint32_t key);
[[nodiscard]] Transport::Completion recordsInto(std::shared_ptr<Inbox> inbox, uint32_t key,
                                                uint64_t sequence,
                                                std::shared_ptr<const RecordRequest> request,
                                                std::shared_ptr<const CodeTables> tables);
[[nodiscard]] Transport::Completion chunkIndexInto(std::shared_ptr<Inbox> inbox, uint32_t key);
[[nodiscard]] Transport::Completion chunkInto(std::shared_ptr<Inbox> inbox, uint32_t key,
                                              uint64_t sequence,
                                              std::shared_ptr<const CodeTables> tables);

}  // namespace meshfront
