// Where a mesh is published: http://HOST:PORT/v1/meshes/NAME (https likewise).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "shared/result.h"

namespace meshfront {

struct MeshUrl {
  std::string origin;  // scheme, host and port, no slash at the end
  std::string prefix;  // path in front of /v1, for services behind a path; "" or "/a/b"
  std::string name;

  [[nodiscard]] std::string metadata() const { return origin + prefix + "/v1/meshes/" + name; }
  [[nodiscard]] std::string base(std::string_view revision) const;
  // The content of the bitstring in base64url, and the parameter ("" or "levels=2") of the request.
  [[nodiscard]] std::string splits(std::string_view revision, std::string_view ids,
                                   std::string_view parameter) const;
  // Target of QUERY: no IDs in the URL.
  [[nodiscard]] std::string splitsQuery(std::string_view revision,
                                        std::string_view parameter) const;
  [[nodiscard]] std::string chunkIndex(std::string_view revision) const;
  [[nodiscard]] std::string chunk(std::string_view revision, uint32_t number) const;
};

// The message of an error says which part is wrong and what is expected.
[[nodiscard]] Result<MeshUrl> parseMeshUrl(std::string_view url);

// Requests with longer URLs are sent by QUERY (nginx stops at 8 KiB, Squid at 8,192 octets).
inline constexpr size_t kMaxUrlOctets = 8000;

}  // namespace meshfront
