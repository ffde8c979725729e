#include "tests/evaluation/sender_driven/hello_messages.h"

#include <bit>
#include <cmath>

#include "shared/camera/camera_spec.h"

namespace meshfront::evaluation {
namespace {

constexpr size_t kMostCameraOctets = 1000;
constexpr int kMostPixels = 16384;

void putWord(std::vector<uint8_t>& out, uint64_t value, size_t bytes) {
  for (size_t i = bytes; i-- > 0;) out.push_back(static_cast<uint8_t>(value >> (8 * i)));
}

uint64_t takeWord(std::span<const uint8_t>& in, size_t bytes) {
  uint64_t value = 0;
  for (size_t i = 0; i < bytes; ++i) value = value << 8 | in[i];
  in = in.subspan(bytes);
  return value;
}

constexpr size_t kMeshHead = 1 + 8 * 10;
constexpr size_t kCameraHead = 2 + 2 + 4;

}  // namespace

std::vector<uint8_t> MeshHello::toBytes() const {
  std::vector<uint8_t> out;
  out.reserve(kMeshHead + base.size());
  out.push_back(static_cast<uint8_t>(quantization.bits));
  putWord(out, std::bit_cast<uint64_t>(quantization.step), 8);
  for (const auto* triple : {&quantization.origin, &boundsMin, &boundsMax})
    for (const double value : *triple) putWord(out, std::bit_cast<uint64_t>(value), 8);
  out.insert(out.end(), base.begin(), base.end());
  return out;
}

Result<MeshHello> MeshHello::fromBytes(std::span<const uint8_t> bytes) {
  if (bytes.size() < kMeshHead) return fail("the server's first message is cut short");
  MeshHello hello;
  hello.quantization.bits = static_cast<unsigned>(takeWord(bytes, 1));
  hello.quantization.step = std::bit_cast<double>(takeWord(bytes, 8));
  bool finite = std::isfinite(hello.quantization.step) && hello.quantization.step > 0;
  for (auto* triple : {&hello.quantization.origin, &hello.boundsMin, &hello.boundsMax})
    for (double& value : *triple) {
      value = std::bit_cast<double>(takeWord(bytes, 8));
      finite = finite && std::isfinite(value);
    }
  if (!finite || hello.quantization.bits > kMaxQuantizationBits)
    return fail("the server's first message has no grid");
  hello.base.assign(bytes.begin(), bytes.end());
  return hello;
}

std::vector<uint8_t> CameraHello::toBytes() const {
  std::vector<uint8_t> out;
  putWord(out, static_cast<uint64_t>(picture.width), 2);
  putWord(out, static_cast<uint64_t>(picture.height), 2);
  putWord(out, std::bit_cast<uint32_t>(tolerance), 4);
  out.insert(out.end(), camera.begin(), camera.end());
  return out;
}

Result<CameraHello> CameraHello::fromBytes(std::span<const uint8_t> bytes) {
  if (bytes.size() < kCameraHead || bytes.size() > kCameraHead + kMostCameraOctets)
    return fail("a camera's message has a wrong length");
  CameraHello hello;
  hello.picture.width = static_cast<int>(takeWord(bytes, 2));
  hello.picture.height = static_cast<int>(takeWord(bytes, 2));
  hello.tolerance = std::bit_cast<float>(static_cast<uint32_t>(takeWord(bytes, 4)));
  if (hello.picture.width < 1 || hello.picture.width > kMostPixels || hello.picture.height < 1 ||
      hello.picture.height > kMostPixels || !(hello.tolerance >= 0))
    return fail("a camera's message has no picture");
  hello.camera.assign(bytes.begin(), bytes.end());
  return hello;
}

Result<ViewRequest> CameraHello::viewOf(const MeshHello& mesh) const {
  const auto spec = parseCameraSpec(camera);
  if (!spec) return tl::unexpected(spec.error());
  const Camera placed =
      placeCamera(*spec, Bounds::of(mesh.boundsMin, mesh.boundsMax), picture.aspect());
  return ViewRequest::of(placed, picture, mesh.quantization, tolerance);
}

}  // namespace meshfront::evaluation
