#include <lzma.h>
#include <zlib.h>
#include <zstd.h>

#include <array>
#include <cstdint>
#include <cstring>

#include "tests/fuzz/seeds.h"

namespace meshfront::fuzz {
namespace {

// Little-endian where the machine is: seeds are made on one that is.
template <typename T>
void put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}
template <typename T>
std::string packed(std::initializer_list<T> values) {
  std::string out;
  for (const T value : values) put(out, value);
  return out;
}
template <typename T>
void putTurned(std::string& out, T value) {
  const auto* bytes = reinterpret_cast<const char*>(&value);
  for (size_t i = sizeof value; i-- > 0;) out.push_back(bytes[i]);
}

std::string binaryPly() {
  std::string out =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float "
      "y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar "
      "blue\nproperty uchar alpha\nelement face 2\nproperty list uchar uint "
      "vertex_indices\nproperty uchar flags\nend_header\n";
  for (const std::array<float, 3> p :
       {std::array{0.F, 0.F, 0.F}, {1.F, 0.F, 0.F}, {1.F, 1.F, 0.F}, {0.F, 1.F, 0.5F}}) {
    for (const float v : p) put(out, v);
    out += "\xff\x80\x40\x20";
  }
  for (const std::array<uint32_t, 3> t : {std::array{0U, 1U, 2U}, {0U, 2U, 3U}}) {
    out.push_back(3);
    for (const uint32_t corner : t) put(out, corner);
    out.push_back(0);
  }
  return out;
}

std::string bigEndianPly() {
  std::string out =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty double x\nproperty short "
      "y\nproperty int z\nelement face 1\nproperty list ushort short vertex_indices\nend_header\n";
  for (int16_t i = 0; i < 3; ++i) {
    putTurned(out, 0.5 * i);
    putTurned(out, static_cast<int16_t>(i * i));
    putTurned(out, int32_t{7});
  }
  putTurned(out, uint16_t{3});
  for (int16_t i = 0; i < 3; ++i) putTurned(out, i);
  return out;
}

std::string binaryStl(uint32_t told) {
  std::string out(80, ' ');
  put(out, told);
  for (float z : {0.F, 1.F}) {
    out += packed<float>({0, 0, 1, 0, 0, z, 1, 0, z, 0, 1, z});
    put(out, uint16_t{0});
  }
  return out;
}

std::string binaryOff() {
  std::string out = "OFF BINARY\n";
  for (const int32_t v : {3, 1, 3}) putTurned(out, v);
  for (const float v : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) putTurned(out, v);
  for (const int32_t v : {3, 0, 1, 2, 0}) putTurned(out, v);
  return out;
}

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t word = 0;
    for (size_t j = 0; j < 3; ++j)
      word = word << 8 | (i + j < bytes.size() ? static_cast<uint8_t>(bytes[i + j]) : 0U);
    for (size_t j = 0; j < 4; ++j)
      out.push_back(i + j > bytes.size() ? '=' : kDigits[word >> (18 - 6 * j) & 63]);
  }
  return out;
}

const std::string& square() {  // positions, normals, colours, indices
  static const std::string kBytes =
      packed<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.5F}) +
      packed<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}) +
      packed<uint8_t>({255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 9, 9, 9, 9}) +
      packed<uint16_t>({0, 1, 2, 0, 2, 3});
  return kBytes;
}

// `more`: members of the document beside views, buffer and version.
std::string document(const std::string& buffer, const std::string& more) {
  return R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":124)" + buffer +
         R"(}],"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,)"
         R"("byteLength":48},{"buffer":0,"byteOffset":96,"byteLength":16},)"
         R"({"buffer":0,"byteOffset":112,"byteLength":12}],)" +
         more + "}";
}
std::string dataUri() {
  return R"(,"uri":"data:application/octet-stream;base64,)" + base64(square()) + R"(")";
}
const std::string kAccessors =
    R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
    R"({"bufferView":1,"componentType":5126,"count":4,"type":"VEC3"},)"
    R"({"bufferView":2,"componentType":5121,"normalized":true,"count":4,"type":"VEC4"},)"
    R"({"bufferView":3,"componentType":5123,"count":6,"type":"SCALAR"}])";
const std::string kMesh =
    R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"COLOR_0":2},)"
    R"("indices":3,"material":0}]}])";
const std::string kScene =
    R"(,"nodes":[{"children":[1],"rotation":[0,0,0.6,0.8]},{"mesh":0,"scale":[-1,2,3]},)"
    R"({"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,5,5,5,1]}],"scenes":[{"nodes":[0,2]}],)"
    R"("scene":0)";

std::string glb(std::string json, std::string binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4);
  std::string out = "glTF";
  put(out, uint32_t{2});
  put(out, static_cast<uint32_t>(12 + 8 + json.size() + 8 + binary.size()));
  put(out, static_cast<uint32_t>(json.size()));
  out += "JSON" + json;
  put(out, static_cast<uint32_t>(binary.size()));
  return out + std::string("BIN\0", 4) + binary;
}

std::string gzipped(const std::string& text) {
  z_stream stream{};
  constexpr int kGzip = 15 + 16;
  deflateInit2(&stream, 9, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&stream, text.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}
std::string xzipped(const std::string& text, lzma_check check) {
  std::string out(lzma_stream_buffer_bound(text.size()), '\0');
  size_t size = 0;
  static_cast<void>(lzma_easy_buffer_encode(
      1, check, nullptr, reinterpret_cast<const uint8_t*>(text.data()), text.size(),
      reinterpret_cast<uint8_t*>(out.data()), &size, out.size()));
  out.resize(size);
  return out;
}
std::string zstandard(const std::string& text) {
  std::string out(ZSTD_compressBound(text.size()), '\0');
  out.resize(ZSTD_compress(out.data(), out.size(), text.data(), text.size(), 3));
  return out;
}

}  // namespace

std::vector<Seed> binaryMeshSeeds() {
  const std::string ply = binaryPly();
  const std::string gltf = document(dataUri(), kAccessors + kMesh + kScene);
  const std::string inGlb = glb(document("", kAccessors + kMesh + kScene), square());
  const std::string fan =
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","sparse":)"
      R"({"count":2,"indices":{"bufferView":3,"componentType":5123},"values":{"bufferView":1}}}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":6},)"
      R"({"attributes":{"POSITION":0},"mode":5},{"attributes":{"POSITION":0},"mode":0}]}],)"
      R"("nodes":[{"mesh":0}])";
  const std::string huge =
      R"("accessors":[{"componentType":5126,"count":2000000000,"type":"VEC3"}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}])";
  const std::string loop = kAccessors + kMesh + R"(,"nodes":[{"children":[1]},{"children":[0]}])";
  std::string doubling = kAccessors + kMesh + R"(,"nodes":[{"mesh":0})";
  for (int i = 1; i < 40; ++i)
    doubling += R"(,{"children":[)" + std::to_string(i - 1) + "," + std::to_string(i - 1) + "]}";
  doubling += "]";
  const std::string text(2000, 'v');
  return {
      {"ply", "valid-little-endian", ply},
      {"ply", "valid-big-endian", bigEndianPly()},
      {"ply", "cut-body", ply.substr(0, ply.size() - 9)},
      {"stl", "valid-binary", binaryStl(2)},
      {"stl", "valid-odd-count", binaryStl(1)},
      {"stl", "odd-count", binaryStl(0xFFFFFFFF)},
      {"stl", "cut-binary", binaryStl(2).substr(0, 120)},
      {"off", "valid-binary", binaryOff()},
      {"off", "cut-binary", binaryOff().substr(0, 50)},
      {"gltf", "valid-scene", gltf},
      {"gltf", "valid-sparse", document(dataUri(), fan)},
      {"gltf", "odd-no-bytes", document(dataUri(), huge)},
      {"gltf", "odd-loop", document(dataUri(), loop)},
      {"gltf", "odd-doubling", document(dataUri(), doubling)},
      {"gltf", "odd-file", document(R"(,"uri":"../../etc/passwd")", kAccessors + kMesh + kScene)},
      {"gltf", "cut", gltf.substr(0, 500)},
      {"glb", "valid-scene", inGlb},
      {"glb", "valid-sparse", glb(document("", fan), square())},
      {"glb", "odd-no-bytes", glb(document("", huge), "")},
      {"glb", "cut", inGlb.substr(0, inGlb.size() - 30)},
      {"glb", "cut-header", inGlb.substr(0, 18)},
      {"compressed", "valid-gzip", gzipped(text)},
      {"compressed", "valid-two-gzip", gzipped(text) + gzipped(ply)},
      {"compressed", "valid-xz", xzipped(ply, LZMA_CHECK_CRC64)},
      {"compressed", "valid-xz-sha", xzipped(text, LZMA_CHECK_SHA256)},
      {"compressed", "valid-zstd", zstandard(ply)},
      {"compressed", "valid-two-zstd", zstandard(text) + zstandard(ply)},
      {"compressed", "odd-gzip-and-more", gzipped(text) + "more"},
      {"compressed", "odd-large", gzipped(std::string(3000000, 'x'))},
      {"compressed", "cut-gzip", gzipped(ply).substr(0, 60)},
      {"compressed", "cut-xz", xzipped(ply, LZMA_CHECK_CRC32).substr(0, 60)},
      {"compressed", "cut-zstd", zstandard(ply).substr(0, 60)},
  };
}

}  // namespace meshfront::fuzz
