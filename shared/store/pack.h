// A pack: one LMDB file with one mesh. Keys: "metadata" (JSON), "base", "chunk-index", "report"
// (JSON: cleaning report and bits by field), and "chunk" + number (4 bytes, big-endian).
// Packs are constants: written once under a temporary name, synced, renamed; opened read-only.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "shared/result.h"
#include "shared/store/mesh_metadata.h"

namespace meshfront {

struct PackContent {
  MeshMetadata metadata;  // revision and byte counts are filled in by writePack
  std::vector<uint8_t> base;
  std::vector<uint8_t> chunkIndex;
  std::vector<std::vector<uint8_t>> chunks;
  std::string reportJson;
};

// The digest over base, chunk index and chunks (and quantisation), the same on every machine.
[[nodiscard]] std::string revisionOf(const PackContent& content);

// Atomic: `path` either keeps its old content or gets the new one whole. Once `cancelled` returns
// true, which is asked now and then, it gives up with an Error and nothing is left behind.
[[nodiscard]] Result<MeshMetadata> writePack(const std::filesystem::path& path, PackContent content,
                                             const std::function<bool()>& cancelled = {});

// An open pack; thread-safe for reading. Views stay valid as long as the Pack lives.
class Pack {
 public:
  [[nodiscard]] static Result<std::shared_ptr<const Pack>> open(const std::filesystem::path& path);
  ~Pack();
  Pack(const Pack&) = delete;
  Pack& operator=(const Pack&) = delete;

  [[nodiscard]] const MeshMetadata& metadata() const;
  [[nodiscard]] std::span<const uint8_t> base() const;
  [[nodiscard]] std::span<const uint8_t> chunkIndex() const;
  [[nodiscard]] Result<std::span<const uint8_t>> chunk(uint32_t number) const;
  [[nodiscard]] std::string_view reportJson() const;

 private:
  struct State;
  explicit Pack(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace meshfront
