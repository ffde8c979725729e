// One request for records: the set, what it adds, and its form on the wire.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/codec/answer.h"
#include "shared/codec/code_tables.h"
#include "shared/hierarchy/node_id.h"
#include "shared/receiver/mesh_url.h"
#include "shared/receiver/transport.h"
#include "shared/result.h"

namespace meshfront {

struct RecordRequest {
  std::vector<NodeId> nodes;    // preorder, an antichain
  std::vector<uint8_t> levels;  // significance, one each: lets any thread parse the answer
  Expansion expansion;
};

// The URL's parameter, "" where the expansion adds nothing.
[[nodiscard]] std::string expansionParameter(const Expansion& expansion);

struct SpelledSet {
  size_t octets = 0;  // of the IDs, as a bitstring
  uint32_t key = 0;   // in the entity tag of the answer (entity_tag.h)
};

// GET while the URL stays within kMaxUrlOctets, else QUERY. Tells of the set in `spelled` if given.
[[nodiscard]] Result<FetchRequest> toFetch(const MeshUrl& url, std::string_view revision,
                                           const RecordRequest& request,
                                           SpelledSet* spelled = nullptr);

// Untrusted answer.
[[nodiscard]] Result<std::vector<RecordEntry>> parseRecords(std::span<const uint8_t> bytes,
                                                            const RecordRequest& request,
                                                            const CodeTables& tables);

}  // namespace meshfront
