// The answer to a request for records: the wanted nodes' records in preorder, bit by bit, without
// framing, zero bits up to a whole byte, CRC-32C. What a request may add to its nodes:
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "shared/codec/chunk.h"
#include "shared/codec/code_tables.h"
#include "shared/hierarchy/node_id.h"
#include "shared/result.h"

namespace meshfront {

// Descendants that a request adds: `levels` generations below each node, or all descendants whose
// significance level is <= `significance` and whose ancestors up to the node are too. At most one.
struct Expansion {
  uint32_t levels = 0;
  std::optional<uint8_t> significance;
  [[nodiscard]] bool none() const { return levels == 0 && !significance; }
};

// Walks an answer. Parents come before children, so that each node's level is known when its record
// is met: for nodes of `wanted` from `levelOf` (nullopt = unknown, an error), below them from the
// records. Untrusted; beyond `maxEntries` ErrorCode::tooLarge. Offsets of entries are into
// `bytes`.
[[nodiscard]] Result<std::vector<RecordEntry>> parseAnswer(
    std::span<const uint8_t> bytes, std::span<const NodeId> wanted, const Expansion& expansion,
    const CodeTables& tables, const std::function<std::optional<unsigned>(const NodeId&)>& levelOf,
    size_t maxEntries = SIZE_MAX);

}  // namespace meshfront
