// Requests for records and their one spelling.
//
// One set, one URL: `ids` is the base64url of the one encoding of the set; the query is nothing,
// levels=K (1 .. kMaxDepth) or significance=L (0 .. the mesh's finest level), decimal without
// leading zeros. Whatever else is refused, so that caches hold no answer twice.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/codec/answer.h"
#include "shared/hierarchy/node_id.h"
#include "shared/result.h"

namespace meshfront {

inline constexpr size_t kMaxTargetOctets = 8000;  // nginx: 8 KiB, Squid: 8,192 octets
// Of a target that an answer names (Content-Location): nginx takes 4 KiB of an answer's fields.
inline constexpr size_t kMaxNamedOctets = 2000;
inline constexpr size_t kMaxContentOctets = size_t{1} << 20;

struct SplitRequest {
  std::vector<NodeId> wanted;  // an antichain in preorder, not empty
  Expansion expansion;
  std::vector<uint8_t> fromUrl{};  // the set's bitstring; empty where it came as content
};

// Untrusted. ErrorCode::tooLarge beyond `maxWanted` nodes, invalid for everything else.
[[nodiscard]] Result<SplitRequest> parseSplitUrl(std::string_view ids, bool hasQuery,
                                                 std::string_view query, unsigned maxLevel,
                                                 size_t maxWanted);
[[nodiscard]] Result<SplitRequest> parseSplitQuery(std::span<const uint8_t> content, bool hasQuery,
                                                   std::string_view query, unsigned maxLevel,
                                                   size_t maxWanted);

// "", "?levels=K" or "?significance=L".
[[nodiscard]] std::string expansionQuery(const Expansion& expansion);
// "/v1/meshes/{mesh}/{revision}/splits/{ids}?..." whatever its length.
[[nodiscard]] std::string splitTarget(std::string_view mesh, std::string_view revision,
                                      std::span<const uint8_t> bitstring,
                                      const Expansion& expansion);

// A whole number without sign or leading zeros.
[[nodiscard]] std::optional<uint32_t> canonicalNumber(std::string_view text);

}  // namespace meshfront
