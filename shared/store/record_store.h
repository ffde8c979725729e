// One revision of one mesh, as the record service asks for it. Programs differ in the store they
// stand on: a pack (service) or a cache over another service (proxy).
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/codec/answer.h"
#include "shared/hierarchy/node_id.h"
#include "shared/result.h"
#include "shared/store/held_bytes.h"

namespace meshfront {

// Whether a call may wait for another machine. Refused, it answers from what is at hand or fails
// with ErrorCode::unavailable at once: then ask again, from a thread that may wait.
enum class Waiting { refused, allowed };

struct CollectLimits {
  size_t maxWanted = size_t{1} << 18;   // nodes in a request
  size_t maxRecords = size_t{1} << 22;  // records in an answer
  size_t maxBytes = size_t{64} << 20;   // bytes of an answer
};

struct Answer {
  std::vector<uint8_t> bytes;  // as parseAnswer() reads it
  uint64_t records = 0;
  // Of a cache: how many of them it did not hold; nothing at the origin.
  std::optional<uint64_t> fetched{};
};

// Thread-safe. Errors: notFound (no such node, a leaf, no such chunk), tooLarge (beyond the
// limits), invalid (the stored bytes are damaged), unavailable and timedOut (the source is away).
class RecordStore {
 public:
  RecordStore() = default;
  virtual ~RecordStore() = default;
  RecordStore(const RecordStore&) = delete;
  RecordStore& operator=(const RecordStore&) = delete;

  [[nodiscard]] virtual Result<HeldBytes> base(Waiting waiting) = 0;
  [[nodiscard]] virtual Result<HeldBytes> chunkIndex(Waiting waiting) = 0;
  [[nodiscard]] virtual Result<HeldBytes> chunk(uint32_t number, Waiting waiting) = 0;
  // The records of `wanted` (an antichain in preorder) and of what `expansion` adds, in preorder.
  [[nodiscard]] virtual Result<Answer> collect(std::span<const NodeId> wanted,
                                               const Expansion& expansion,
                                               const CollectLimits& limits, Waiting waiting) = 0;
  // The finest significance level of any node: a larger one in a request adds nothing.
  [[nodiscard]] virtual Result<unsigned> maxLevel() = 0;
  // An upper bound of the time since the content left its origin; nothing at the origin itself.
  [[nodiscard]] virtual std::optional<std::chrono::seconds> age() const { return std::nullopt; }
};

}  // namespace meshfront
