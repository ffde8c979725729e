// What of a glTF 2.0 file (Khronos, ISO/IEC 12113) concerns triangles, as plain structures. Members
// are named as in the specification.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/result.h"

namespace meshfront {

struct GltfBuffer {
  std::string uri;  // empty: the binary chunk of a GLB file
  uint64_t byteLength = 0;
};

struct GltfBufferView {
  uint32_t buffer = 0;
  uint64_t byteOffset = 0;
  uint64_t byteLength = 0;
  uint64_t byteStride = 0;   // 0: tightly packed
  std::string compressedBy;  // an extension, if there is one
};

enum class GltfComponent { int8, uint8, int16, uint16, uint32, float32 };

struct GltfSparse {
  uint64_t count = 0;
  uint32_t indicesView = 0;
  uint64_t indicesOffset = 0;
  GltfComponent indicesType = GltfComponent::uint32;
  uint32_t valuesView = 0;
  uint64_t valuesOffset = 0;
};

struct GltfAccessor {
  std::optional<uint32_t> bufferView;  // none: zeros
  uint64_t byteOffset = 0;
  GltfComponent componentType = GltfComponent::float32;
  bool normalized = false;
  uint64_t count = 0;
  unsigned components = 1;  // 1 .. 4; 0: a matrix, which no attribute read here is
  std::optional<GltfSparse> sparse;
};

struct GltfPrimitive {
  uint64_t mode = 4;  // 0 points, 1 to 3 lines, 4 triangles, 5 strip, 6 fan
  std::optional<uint32_t> indices;
  std::optional<uint32_t> position;
  std::optional<uint32_t> normal;
  std::optional<uint32_t> colour;
  bool hasTextureCoordinates = false;
  uint64_t morphTargets = 0;
  std::vector<std::string> otherAttributes;
  std::string compressedBy;  // an extension, if there is one
};

struct GltfMesh {
  std::vector<GltfPrimitive> primitives;
};

// Column by column, of 4 x 3 numbers: the images of x, y and z, and the translation.
using GltfTransform = std::array<double, 12>;

struct GltfNode {
  std::vector<uint32_t> children;
  std::optional<uint32_t> mesh;
  bool hasSkin = false;
  bool hasInstances = false;  // EXT_mesh_gpu_instancing
  GltfTransform transform = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
};

struct GltfModel {
  std::vector<GltfBuffer> buffers;
  std::vector<GltfBufferView> bufferViews;
  std::vector<GltfAccessor> accessors;
  std::vector<GltfMesh> meshes;
  std::vector<GltfNode> nodes;
  std::vector<std::vector<uint32_t>> scenes;  // each the numbers of its root nodes
  std::optional<uint32_t> scene;
  uint64_t materials = 0;
  uint64_t images = 0;
  uint64_t skins = 0;
  uint64_t animations = 0;
};

// A GLB file's chunks; of a .gltf file, which is nothing but JSON, the latter.
struct GltfChunks {
  std::string_view json;
  size_t jsonOffset = 0;  // in the file
  std::optional<std::string_view> binary;
};

// Untrusted. Errors name the byte.
[[nodiscard]] Result<GltfChunks> splitGltf(std::string_view file);

// Untrusted; every number of a thing is smaller than there are such things, every real is finite.
// Errors name the byte, or the place as in "meshes[2].primitives[0]: ...". An Error also if the
// file requires an extension that would change the triangles and is not known here.
[[nodiscard]] Result<GltfModel> parseGltfModel(const GltfChunks& chunks);

}  // namespace meshfront
