// The keys of a pack, shared by its writer and its reader.
#pragma once

#include <cstdint>
#include <string>

namespace meshfront::pack_keys {

inline constexpr const char* kMetadata = "metadata";
inline constexpr const char* kBase = "base";
inline constexpr const char* kChunkIndex = "chunk-index";
inline constexpr const char* kReport = "report";

// Big-endian, so that LMDB keeps the chunks in their order.
inline std::string chunk(uint32_t number) {
  std::string key = "chunk";
  for (int shift = 24; shift >= 0; shift -= 8) key.push_back(static_cast<char>(number >> shift));
  return key;
}

}  // namespace meshfront::pack_keys
