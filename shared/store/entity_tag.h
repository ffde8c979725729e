// The entity tags of the interface. They name the resource that an answer belongs to, so that a
// receiver or a proxy notices when something in between - a cache that mixed up two entries, a
// server of another revision - answers with what is sound in itself but not what was asked for: the
// checksum of records of other nodes is right, too.
//
//   catalogue, metadata   "DIGEST"               of the content, 32 hexadecimal digits
//   base, index, chunks   "REVISION-KEY"         KEY: see resourceKey(), 8 hexadecimal digits
//   records               "CHECKSUM-LENGTH-KEY"  of the content
//
// This guards against mistakes, not against who forges tags. Caches hand strong tags on as they
// are; a missing tag, a weak one or one of another form is nobody's fault and tells nothing.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "shared/codec/answer.h"

namespace meshfront {

// Of a constant: `resource` as in its URL behind the revision, "base", "chunks" or "chunks/N".
[[nodiscard]] uint32_t resourceKey(std::string_view revision, std::string_view resource);
// Of the records of a set, by its bitstring; GET and QUERY have the same.
[[nodiscard]] uint32_t recordsKey(std::string_view revision, std::span<const uint8_t> bitstring,
                                  const Expansion& expansion);

// All of them with quotes.
[[nodiscard]] std::string documentTag(std::span<const uint8_t> content);
[[nodiscard]] std::string constantTag(std::string_view revision, uint32_t key);
[[nodiscard]] std::string recordsTag(std::span<const uint8_t> content, uint32_t key);

// Untrusted tags. True where the tag is of the form above and tells that the answer is another one.
[[nodiscard]] bool isTagOfOtherDocument(std::string_view tag, std::span<const uint8_t> content);
[[nodiscard]] bool isTagOfOtherResource(std::string_view tag, uint32_t key);

}  // namespace meshfront
