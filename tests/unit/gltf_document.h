// glTF documents written by hand.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <initializer_list>
#include <string>
#include <vector>

#include "shared/mesh_files/mesh_files.h"

namespace meshfront {

// Collects the bytes of one buffer; view() gives the JSON of a bufferView on what was added last.
class GltfBuffer {
 public:
  template <typename T>
  GltfBuffer& add(std::initializer_list<T> values) {
    start_ = bytes_.size();
    for (const T value : values) {
      bytes_.resize(bytes_.size() + sizeof value);
      std::memcpy(bytes_.data() + bytes_.size() - sizeof value, &value, sizeof value);
    }
    return *this;
  }
  [[nodiscard]] std::string view(const std::string& more = "") const {
    return R"({"buffer":0,"byteOffset":)" + std::to_string(start_) + R"(,"byteLength":)" +
           std::to_string(bytes_.size() - start_) + more + "}";
  }
  [[nodiscard]] const std::string& all() const { return bytes_; }

 private:
  std::string bytes_;
  size_t start_ = 0;
};

inline void appendWord(std::string& out, size_t word) {
  for (int i = 0; i < 4; ++i) out += static_cast<char>(word >> (8 * i));
}

// A GLB file of a document, which lacks its outer braces and its buffer, and the buffer.
inline std::string glb(const std::string& members, const std::string& bytes) {
  std::string json = R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":)" +
                     std::to_string(bytes.size()) + "}]," + members + "}";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string binary = bytes;
  binary.resize((binary.size() + 3) / 4 * 4);
  std::string out = "glTF";
  appendWord(out, 2);
  appendWord(out, 12 + 8 + json.size() + 8 + binary.size());
  appendWord(out, json.size());
  out += "JSON" + json;
  appendWord(out, binary.size());
  return out + std::string("BIN\0", 4) + binary;
}

inline IndexedMesh parsedGltf(const std::string& file) {
  auto mesh = parseMesh(file, MeshFormat::gltf);
  EXPECT_TRUE(mesh) << mesh.error().message;
  return mesh ? std::move(*mesh) : IndexedMesh();
}
inline std::string problemOfGltf(const std::string& file) {
  const auto mesh = parseMesh(file, MeshFormat::gltf);
  return mesh ? std::string("none") : mesh.error().message;
}

inline const std::vector<std::array<double, 3>> kGltfSquare = {
    {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5}};
inline GltfBuffer squarePositions() {
  return GltfBuffer().add<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.5F});
}
inline const std::string kPositionAccessor =
    R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"})";

// A square of the given primitives; views and accessors behind those of the positions.
inline std::string squareGlb(
    const GltfBuffer& bytes, const std::string& views, const std::string& accessors,
    const std::string& primitives,
    const std::string& scene = R"("nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}])") {
  return glb(R"("bufferViews":[{"buffer":0,"byteLength":48})" + views + R"(],"accessors":[)" +
                 kPositionAccessor + accessors + R"(],"meshes":[{"primitives":[)" + primitives +
                 "]}]," + scene,
             bytes.all());
}
inline std::string indexedSquare(const std::string& scene) {
  GltfBuffer bytes = squarePositions();
  bytes.add<uint8_t>({0, 1, 2, 0, 2, 3});
  return squareGlb(bytes, "," + bytes.view(),
                   R"(,{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"})",
                   R"({"attributes":{"POSITION":0},"indices":1})", scene);
}

}  // namespace meshfront
