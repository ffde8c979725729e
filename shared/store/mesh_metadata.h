// What a catalogue says of one mesh. Stored in the pack as JSON, served with the revision and the
// URI templates of what follows added.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/mesh/quantization.h"
#include "shared/result.h"

namespace meshfront {

struct MeshMetadata {
  std::string name;            // [A-Za-z0-9._-]{1,64}, not starting with a dot
  std::string revision;        // 32 lower-case hex digits: SHA-256 over the pack's content, cut
  uint64_t vertexCount = 0;    // of the finest mesh, virtual ones not counted
  uint64_t triangleCount = 0;  // likewise
  uint64_t baseVertexCount = 0;
  uint64_t baseTriangleCount = 0;  // drawn ones
  uint64_t splitCount = 0;
  unsigned maxLevel = 0;
  unsigned maxDepth = 0;  // of any node
  Quantization quantization;
  std::array<double, 3> boundsMin{};  // world
  std::array<double, 3> boundsMax{};
  std::vector<std::string> attributes;  // beside positions: of "colour" and "normal"
  uint64_t baseBytes = 0;
  uint64_t recordBytes = 0;  // all records, bit-packed
  uint64_t chunkBytes = 0;
  uint32_t chunkCount = 0;
};

[[nodiscard]] bool isMeshName(std::string_view name);
[[nodiscard]] bool isRevision(std::string_view revision);
[[nodiscard]] std::string toJson(const MeshMetadata& metadata);  // with links of the interface
// The catalogue of these meshes, in their order.
[[nodiscard]] std::string catalogueJson(std::span<const MeshMetadata> meshes);
[[nodiscard]] Result<MeshMetadata> metadataFromJson(std::string_view json);  // untrusted

}  // namespace meshfront
